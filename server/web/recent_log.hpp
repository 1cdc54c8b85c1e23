// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"

namespace bpa::server::web {

/// The last lines of the log. Thread-safe.
class RecentLog {
 public:
  static constexpr std::size_t kKept = 300;

  struct Line {
    std::uint64_t id = 0;  ///< From 1, rising.
    std::int64_t stamp_ns = 0;
    LogLevel level{};
    std::string text;
  };

  /// A hook that keeps each line and passes it on. It may be called after this is gone.
  LogHook before(LogHook sink) const {
    return [state = state_, sink = std::move(sink)](LogLevel level, const LogMessage& said) {
      {
        const std::lock_guard<std::mutex> lock(state->mutex);
        state->lines.push_back({state->next++, unix_time_ns(), level, std::string(said.text)});
        if (state->lines.size() > kKept) state->lines.pop_front();
      }
      if (sink) sink(level, said);
    };
  }

  /// The lines after this one, 0: all that are kept.
  std::vector<Line> after(std::uint64_t id) const {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    std::vector<Line> lines;
    for (const Line& line : state_->lines) {
      if (line.id > id) lines.push_back(line);
    }
    return lines;
  }

 private:
  struct State {
    std::mutex mutex;
    std::uint64_t next = 1;
    std::deque<Line> lines;
  };
  const std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace bpa::server::web
