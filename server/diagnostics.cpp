// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/diagnostics.hpp"

#include <cstdio>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

using wire::bpa_msgs::GetStatus_Response;
using wire::diagnostic_msgs::DiagnosticStatus;

constexpr auto kWindow = std::chrono::seconds(10);

std::string number(double value, const char* format = "%.2f") {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// A DiagnosticStatus that is being filled in.
class Line {
 public:
  Line(const Health& health, const std::string& what) {
    status_.name = health.node + ": " + what;
    status_.hardware_id = "bpa-server " + health.status.version;
  }
  void say(std::byte level, std::string message) {
    status_.level = level;
    status_.message = std::move(message);
  }
  void add(const std::string& key, std::string value) {
    status_.values.push_back({key, std::move(value)});
  }
  void add(const std::string& key, std::uint64_t value) { add(key, std::to_string(value)); }
  DiagnosticStatus& status() { return status_; }

 private:
  DiagnosticStatus status_;
};

const char* state_name(std::uint8_t state) {
  if (state == GetStatus_Response::kPaused) return "paused: frames are searched on request only";
  return state == GetStatus_Response::kIdle ? "idle: no frame comes in" : "running";
}

Line detection_line(const Health& health) {
  Line line(health, "detection");
  const bool empty = health.status.model_count == 0;
  line.say(empty ? DiagnosticStatus::kError : DiagnosticStatus::kOk,
           empty ? "the model library is empty" : state_name(health.status.state));
  line.add("frames received per s", number(health.rates.frames_received));
  line.add("frames searched per s", number(health.rates.frames_processed));
  line.add("frames dropped per s", number(health.rates.frames_dropped));
  line.add("requests served per s", number(health.rates.requests_served));
  line.add("frames received", health.status.frames_received);
  line.add("frames searched", health.status.frames_processed);
  line.add("requests served", health.status.requests_served);
  for (const auto& pair : health.fusion) line.add(pair.key, pair.value);
  for (const auto& timing : health.status.stage_timings) {
    line.add("median ms of " + timing.name, number(timing.duration_ms, "%.3f"));
  }
  line.add("memory MB", number(1e-6 * static_cast<double>(health.status.memory_bytes), "%.1f"));
  line.add("uptime s", number(health.status.uptime_s, "%.0f"));
  return line;
}

Line drops_line(const Health& health) {
  Line line(health, "drops");
  const bool bad = health.rates.frames_bad > 0;
  line.say(bad ? DiagnosticStatus::kWarn : DiagnosticStatus::kOk,
           bad ? number(health.rates.frames_bad) + " frames per s are refused or fail"
               : number(health.rates.frames_dropped) + " frames per s give way to newer ones");
  line.add("frames dropped for newer ones", health.status.frames_dropped);
  for (const auto& [cause, count] : health.drops) line.add(cause, count);
  return line;
}

Line queue_line(const Health& health) {
  Line line(health, "queue");
  const bool refuses = health.rates.requests_refused > 0;
  line.say(refuses ? DiagnosticStatus::kWarn : DiagnosticStatus::kOk,
           refuses ? number(health.rates.requests_refused) + " requests per s are refused"
                   : "no request is refused");
  line.add("length", health.status.queue_length);
  line.add("capacity", health.status.queue_capacity);
  line.add("requests refused", health.status.requests_refused);
  return line;
}

Line models_line(const Health& health) {
  Line line(health, "models");
  const bool empty = health.status.model_count == 0;
  line.say(
      empty ? DiagnosticStatus::kError : DiagnosticStatus::kOk,
      empty ? "the model library is empty" : std::to_string(health.status.model_count) + " models");
  line.add("library", health.status.library);
  line.add("database version", std::to_string(health.status.database_version));
  line.add("models", health.status.model_count);
  return line;
}

}  // namespace

void RateMeter::add(TimePoint now, const Counts& counts) {
  readings_.emplace_back(now, counts);
  // The oldest one that is kept is the last before the window.
  while (readings_.size() > 2 && now - readings_[1].first >= kWindow) readings_.pop_front();
}

Rates RateMeter::rates() const {
  if (readings_.size() < 2) return {};
  const auto& [then, before] = readings_.front();
  const auto& [now, after] = readings_.back();
  const double seconds = std::chrono::duration<double>(now - then).count();
  if (!(seconds > 0)) return {};
  const Counts& a = before;
  const Counts& b = after;
  const auto rate = [&](std::uint64_t Counts::*counter) {
    return static_cast<double>(b.*counter - a.*counter) / seconds;
  };
  Rates rates;
  rates.frames_received = rate(&Counts::frames_received);
  rates.frames_processed = rate(&Counts::frames_processed);
  rates.frames_dropped = rate(&Counts::frames_dropped);
  rates.frames_bad = rate(&Counts::frames_rejected) + rate(&Counts::frames_failed);
  rates.requests_served = rate(&Counts::requests_served);
  rates.requests_refused = rate(&Counts::requests_refused);
  return rates;
}

wire::diagnostic_msgs::DiagnosticArray diagnostics_message(const Health& health,
                                                           std::int64_t stamp_ns) {
  wire::diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = wire::builtin_interfaces::from_ns(stamp_ns);
  for (Line line :
       {detection_line(health), drops_line(health), queue_line(health), models_line(health)}) {
    array.status.push_back(std::move(line.status()));
  }
  for (SourceReport source : health.sources) {
    source.name = health.node + ": " + source.name;
    array.status.push_back(std::move(source));
  }
  return array;
}

}  // namespace bpa::server
