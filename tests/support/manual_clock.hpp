// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "core/base/clock.hpp"

namespace bpa::support {

/// A clock that stands still until it is advanced.
class ManualClock : public WaitableClock {
 public:
  TimePoint now() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return now_;
  }
  void wait_until(std::condition_variable& wake, std::unique_lock<std::mutex>& lock,
                  TimePoint until) override {
    const Waiter waiter{lock.mutex(), &wake, until};
    {
      const std::lock_guard<std::mutex> guard(mutex_);
      if (now_ >= until) return;
      waiters_.push_back(waiter);
      came_.notify_all();
    }
    wake.wait(lock);
    const std::lock_guard<std::mutex> guard(mutex_);
    waiters_.erase(std::find(waiters_.begin(), waiters_.end(), waiter));
  }

  /// Waits until a thread waits for the time that is `ahead` from now; false when none does in 20 s
  /// of real time.
  bool wait_for_sleeper(std::chrono::milliseconds ahead) {
    std::unique_lock<std::mutex> lock(mutex_);
    return came_.wait_for(lock, std::chrono::seconds(20), [&] {
      return std::any_of(waiters_.begin(), waiters_.end(),
                         [&](const Waiter& waiter) { return waiter.until == now_ + ahead; });
    });
  }
  /// Moves the time on and wakes everybody who waits.
  void advance(std::chrono::milliseconds time) {
    std::vector<Waiter> waiters;
    {
      const std::lock_guard<std::mutex> guard(mutex_);
      now_ += time;
      waiters = waiters_;
    }
    for (const Waiter& waiter : waiters) {
      { const std::lock_guard<std::mutex> lock(*waiter.mutex); }  // until it waits
      waiter.wake->notify_all();
    }
  }

 private:
  struct Waiter {
    std::mutex* mutex;
    std::condition_variable* wake;
    TimePoint until;
    bool operator==(const Waiter&) const = default;
  };

  mutable std::mutex mutex_;
  std::condition_variable came_;
  TimePoint now_{std::chrono::hours(1)};
  std::vector<Waiter> waiters_;
};

}  // namespace bpa::support
