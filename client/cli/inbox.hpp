// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "client/cli/commands.hpp"

namespace bpa::cli {

/// What a subscription delivers, in order. add() is called by the SDK's thread. Items that are
/// waited for have a stamp_ns.
template <class T>
class Inbox {
 public:
  void add(T item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.push_back(std::move(item));
    changed_.notify_all();
  }
  /// Takes out everything that came so far.
  std::vector<T> take_all() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(items_, {});
  }
  /// False when the item of that stamp does not come in time.
  bool wait(std::int64_t stamp_ns, double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    return wait(lock, stamp_ns, seconds) != items_.end();
  }
  /// Waits for the item of that stamp and takes it out; none when it does not come in time.
  std::optional<T> take(std::int64_t stamp_ns, double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto found = wait(lock, stamp_ns, seconds);
    if (found == items_.end()) return {};
    std::optional<T> item = std::move(*found);
    items_.erase(found);
    return item;
  }

 private:
  using Clock = std::chrono::steady_clock;

  auto wait(std::unique_lock<std::mutex>& lock, std::int64_t stamp_ns, double seconds) {
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (true) {
      const auto found = std::ranges::find(items_, stamp_ns, &T::stamp_ns);
      if (found != items_.end() || interrupted() || Clock::now() >= end) return found;
      changed_.wait_for(lock, std::chrono::milliseconds(20));
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> items_;
};

}  // namespace bpa::cli
