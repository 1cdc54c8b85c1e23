// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/log_relay.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "idl/wire/time.hpp"
#include "server/log_filter.hpp"

namespace bpa::server {
namespace {

using wire::rcl_interfaces::Log;

constexpr std::size_t kMaxWaiting = 256;

constexpr std::uint8_t kRosLevels[] = {Log::kDebug, Log::kInfo, Log::kWarn, Log::kError};

/// "/bpa/server" -> "bpa.server".
std::string logger_name(std::string node) {
  std::replace(node.begin(), node.end(), '/', '.');
  return node.substr(1);
}

/// "server/server.cpp" of a file of this project, wherever it was compiled.
std::string below_sources(const char* file) {
  constexpr std::string_view kThis = __FILE__, kBelow = "server/log_relay.cpp";
  static_assert(kThis.substr(kThis.size() - kBelow.size()) == kBelow);
  constexpr std::string_view kSources = kThis.substr(0, kThis.size() - kBelow.size());
  const std::string_view path = file;
  return std::string(path.substr(path.rfind(kSources, 0) == 0 ? kSources.size() : 0));
}

}  // namespace

struct LogRelay::State {
  LogHook sink;
  std::atomic<LogLevel> least;
  std::shared_ptr<WaitableClock> clock;
  std::mutex filter_mutex;
  LogFilter filter;
  std::mutex mutex;
  std::condition_variable_any changed;
  std::deque<Log> waiting;
  std::uint64_t lost = 0;

  void take(LogLevel level, const LogMessage& said) {
    if (level < least) return;
    std::optional<std::string> line;
    {
      const std::lock_guard<std::mutex> lock(filter_mutex);
      line = filter.pass(level, said, clock->now());
    }
    if (line) say(level, *line, said.location);
  }

  void say(LogLevel level, const std::string& text,
           SourceLocation location = SourceLocation::current()) {
    log(sink, level, text, location);
    Log message;
    message.stamp = wire::builtin_interfaces::from_ns(unix_time_ns());
    message.level = kRosLevels[static_cast<std::size_t>(level)];
    message.msg = text;
    message.file = below_sources(location.file);
    message.function = location.function;
    message.line = static_cast<std::uint32_t>(location.line);
    const std::lock_guard<std::mutex> lock(mutex);
    if (waiting.size() >= kMaxWaiting) {
      waiting.pop_front();
      ++lost;
    }
    waiting.push_back(std::move(message));
    changed.notify_one();
  }
};

LogRelay::LogRelay(LogHook sink, LogLevel least, std::shared_ptr<WaitableClock> clock)
    : state_(std::make_shared<State>()) {
  state_->clock = std::move(clock);
  state_->sink = std::move(sink);
  state_->least = least;
}

LogHook LogRelay::hook() const {
  return [state = state_](LogLevel level, const LogMessage& said) { state->take(level, said); };
}

void LogRelay::set_level(LogLevel least) { state_->least = least; }

void LogRelay::report_left_out() {
  std::vector<std::string> lines;
  {
    const std::lock_guard<std::mutex> lock(state_->filter_mutex);
    lines = state_->filter.left_out(state_->clock->now());
  }
  for (const std::string& line : lines) state_->say(LogLevel::warning, line);
}

void LogRelay::connect(const wire::Participant& participant, const std::string& topic) {
  rosout_.open(participant, topic, wire::qos::rosout());
  logger_ = logger_name(participant.node().full());
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void LogRelay::run(const std::stop_token& stop) {
  std::unique_lock<std::mutex> lock(state_->mutex);
  while (true) {
    state_->changed.wait(lock, stop, [this] { return !state_->waiting.empty(); });
    if (state_->waiting.empty()) return;  // stopped, after all was published
    Log message = std::move(state_->waiting.front());
    state_->waiting.pop_front();
    if (const auto lost = std::exchange(state_->lost, 0); lost > 0) {
      message.msg += " (" + std::to_string(lost) + " earlier messages are not in /rosout)";
    }
    lock.unlock();
    message.name = logger_;
    // A failure is not logged: it would come here.
    if (!rosout_.publish(message).ok()) {
      const std::lock_guard<std::mutex> again(state_->mutex);
      ++state_->lost;
    }
    lock.lock();
  }
}

LogLevel log_level(const std::string& word) {
  if (word == "debug") return LogLevel::debug;
  if (word == "warning" || word == "warn") return LogLevel::warning;
  if (word == "error" || word == "fatal") return LogLevel::error;
  return LogLevel::info;
}

}  // namespace bpa::server
