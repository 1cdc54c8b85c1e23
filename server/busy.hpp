// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/clock.hpp"

namespace bpa::server {

/// What a thread works on, and for how long: who looks sees that it hangs. Thread-safe.
class Busy {
 public:
  explicit Busy(std::shared_ptr<const WaitableClock> clock = steady_clock())
      : clock_(std::move(clock)) {}

  /// `work` is what it is called in messages: "the search of a frame".
  void begin(std::string work) {
    const std::lock_guard<std::mutex> lock(mutex_);
    work_ = std::move(work);
    since_ = clock_->now();
  }
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    since_.reset();
  }

  struct Work {
    std::string name;
    double seconds = 0;  ///< Since it began.
  };
  /// Nothing while the thread waits.
  std::optional<Work> work() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!since_) return std::nullopt;
    return Work{work_, std::chrono::duration<double>(clock_->now() - *since_).count()};
  }

 private:
  const std::shared_ptr<const WaitableClock> clock_;
  mutable std::mutex mutex_;
  std::string work_;
  std::optional<WaitableClock::TimePoint> since_;
};

}  // namespace bpa::server
