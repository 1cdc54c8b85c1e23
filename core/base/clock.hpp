// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>

namespace bpa {

/// Unix time of this machine in nanoseconds, as stamps of messages have it.
inline std::int64_t unix_time_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

/// std::chrono::steady_clock as a clock that threads can wait on. Tests pass one that they move by
/// hand.
class WaitableClock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  virtual ~WaitableClock() = default;

  virtual TimePoint now() const { return std::chrono::steady_clock::now(); }
  /// Time as stamps of messages have it, in nanoseconds.
  virtual std::int64_t stamp_ns() const { return unix_time_ns(); }
  /// Whether it goes as fast as this machine's time, as work does.
  virtual bool is_real() const { return true; }
  /// Waits until `wake` is notified or `until` is reached; may return earlier, so call it in a loop
  /// that checks its condition. `lock` is held.
  virtual void wait_until(std::condition_variable& wake, std::unique_lock<std::mutex>& lock,
                          TimePoint until) {
    wake.wait_until(lock, until);
  }
};

inline std::shared_ptr<WaitableClock> steady_clock() { return std::make_shared<WaitableClock>(); }

}  // namespace bpa
