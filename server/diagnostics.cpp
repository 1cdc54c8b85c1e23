// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/diagnostics.hpp"

#include <concepts>
#include <cstdio>

#include "core/base/concat.hpp"
#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

using wire::bpa_msgs::GetStatus_Response;
using wire::diagnostic_msgs::DiagnosticStatus;
using wire::diagnostic_msgs::KeyValue;

constexpr auto kWindow = std::chrono::seconds(10);

std::string text(double value, const char* format = "%.2f") {
  char digits[64];
  std::snprintf(digits, sizeof digits, format, value);
  return digits;
}
template <std::integral Integer>
std::string text(Integer value) {
  return std::to_string(value);
}

DiagnosticStatus line(const Health& health, const char* what, std::byte level, std::string message,
                      std::vector<KeyValue> values) {
  return {level, health.node + ": " + what, std::move(message),
          "bpa-server " + health.status.version, std::move(values)};
}

const char* state_name(std::uint8_t state) {
  if (state == GetStatus_Response::kPaused) return "paused: frames are searched on request only";
  return state == GetStatus_Response::kIdle ? "idle: no frame comes in" : "running";
}

DiagnosticStatus detection_line(const Health& health) {
  const GetStatus_Response& status = health.status;
  std::vector<KeyValue> values = {{"frames received per s", text(health.rates.frames_received)},
                                  {"frames searched per s", text(health.rates.frames_processed)},
                                  {"frames dropped per s", text(health.rates.frames_dropped)},
                                  {"requests served per s", text(health.rates.requests_served)},
                                  {"frames received", text(status.frames_received)},
                                  {"frames searched", text(status.frames_processed)},
                                  {"requests served", text(status.requests_served)}};
  values.insert(values.end(), health.fusion.begin(), health.fusion.end());
  for (const auto& timing : status.stage_timings) {
    values.push_back({"median ms of " + timing.name, text(timing.duration_ms, "%.3f")});
  }
  for (const auto& [name, count] : health.effort) {
    values.push_back({"median " + name, text(count, "%.0f")});
  }
  values.push_back({"memory MB", text(1e-6 * static_cast<double>(status.memory_bytes), "%.1f")});
  values.push_back({"uptime s", text(status.uptime_s, "%.0f")});
  const bool empty = status.model_count == 0;
  const bool bad = empty || !health.hang.empty();
  const std::string message = empty ? "the model library is empty" : state_name(status.state);
  return line(health, "detection", bad ? DiagnosticStatus::kError : DiagnosticStatus::kOk,
              health.hang.empty() ? message : health.hang, std::move(values));
}

DiagnosticStatus drops_line(const Health& health) {
  std::vector<KeyValue> values = {{"frames dropped", text(health.status.frames_dropped)}};
  for (const auto& [cause, count] : health.drops) values.push_back({cause, text(count)});
  const Rates& rates = health.rates;
  const bool bad = rates.frames_bad > 0;
  return line(health, "drops", bad ? DiagnosticStatus::kWarn : DiagnosticStatus::kOk,
              bad ? text(rates.frames_bad) + " frames per s are refused or fail"
                  : text(rates.frames_dropped) + " frames per s are not searched",
              std::move(values));
}

DiagnosticStatus queue_line(const Health& health) {
  const double refused = health.rates.requests_refused, lost = health.rates.requests_lost;
  std::vector<KeyValue> values = {{"length", text(health.status.queue_length)},
                                  {"capacity", text(health.status.queue_capacity)},
                                  {"requests refused", text(health.status.requests_refused)}};
  for (KeyValue& loss : loss_values(health.losses)) values.push_back(std::move(loss));
  const bool bad = refused > 0 || lost > 0;
  return line(health, "queue", bad ? DiagnosticStatus::kWarn : DiagnosticStatus::kOk,
              bad ? text(refused) + " requests per s are refused, " + text(lost) + " get lost"
                  : "no request is refused or lost",
              std::move(values));
}

DiagnosticStatus models_line(const Health& health) {
  const std::string count = text(health.status.model_count);
  const bool empty = health.status.model_count == 0;
  return line(health, "models", empty ? DiagnosticStatus::kError : DiagnosticStatus::kOk,
              empty ? "the model library is empty" : count + " models",
              {{"library", health.status.library},
               {"database version", text(health.status.database_version)},
               {"models", count}});
}

}  // namespace

void RateMeter::add(TimePoint now, const Counts& counts) {
  readings_.emplace_back(now, counts);
  // The oldest one that is kept is the last before the window.
  while (readings_.size() > 2 && now - readings_[1].first >= kWindow) readings_.pop_front();
}

Rates RateMeter::rates() const {
  if (readings_.size() < 2) return {};
  const auto& before = readings_.front();
  const auto& after = readings_.back();
  const double seconds = std::chrono::duration<double>(after.first - before.first).count();
  if (!(seconds > 0)) return {};
  const auto rate = [&](std::uint64_t Counts::*counter) {
    return static_cast<double>(after.second.*counter - before.second.*counter) / seconds;
  };
  const auto lost = [](const RequestLosses& l) { return l.malformed + l.lost + l.replies_dropped; };
  const std::uint64_t losses = lost(after.second.losses) - lost(before.second.losses);
  return {.frames_received = rate(&Counts::frames_received),
          .frames_processed = rate(&Counts::frames_processed),
          .frames_dropped = rate(&Counts::frames_dropped),
          .frames_bad = rate(&Counts::frames_rejected) + rate(&Counts::frames_failed),
          .requests_served = rate(&Counts::requests_served),
          .requests_refused = rate(&Counts::requests_refused),
          .requests_lost = static_cast<double>(losses) / seconds};
}

std::vector<std::pair<std::string, std::uint64_t>> drop_counts(const Statistics& statistics) {
  std::vector<std::pair<std::string, std::uint64_t>> drops = {
      {"frames failed in the search", statistics.counts().frames_failed},
      {"frames dropped as the scene stands still", statistics.counts().frames_at_rest}};
  for (const auto& [cause, count] : statistics.rejections()) {
    drops.emplace_back("rejected: " + cause, count);
  }
  return drops;
}

std::vector<KeyValue> fusion_values(const Statistics& statistics, int fuse_frames) {
  const Counts counts = statistics.counts();
  if (fuse_frames == 1 && counts.fusion_restarts == 0) return {};
  std::vector<KeyValue> values = {
      {"frames searched as a part of newer ones", text(counts.frames_fused)},
      {"frames combined anew", text(counts.fusion_restarts)}};
  const std::string reason = statistics.fusion_restart();
  if (!reason.empty()) values.push_back({"frames last combined anew because", reason});
  return values;
}

std::string sync_complaint(const ros::SyncCounts& sync, const InputOptions& input) {
  const std::string cause =
      sync.nearest_miss_ns > 0
          ? concat("the nearest one was ", static_cast<double>(sync.nearest_miss_ns) * 1e-6,
                   " ms away (input.sync_tolerance_ms is ", input.sync_tolerance_ms, ")")
          : concat("are ", input.color, " and ", input.camera_info, " published?");
  return concat(sync.depth_without_color + sync.depth_without_info,
                " depth images had no partner: ", sync.depth_without_color,
                " without a colour image, ", sync.depth_without_info, " without a camera info; ",
                cause);
}

std::vector<KeyValue> loss_values(const RequestLosses& losses) {
  return {{"requests malformed", text(losses.malformed)},
          {"requests lost by DDS", text(losses.lost)},
          {"replies not delivered", text(losses.replies_dropped)}};
}

wire::diagnostic_msgs::DiagnosticArray diagnostics_message(const Health& health,
                                                           std::int64_t stamp_ns) {
  wire::diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = wire::builtin_interfaces::from_ns(stamp_ns);
  array.status = {detection_line(health), drops_line(health), queue_line(health),
                  models_line(health)};
  for (SourceReport source : health.sources) {
    source.name = health.node + ": " + source.name;
    array.status.push_back(std::move(source));
  }
  return array;
}

}  // namespace bpa::server
