// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace bpa::support {

/// What came from a callback, and a wait for one that is as expected.
template <class T>
class Latest {
 public:
  void add(const T& item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.push_back(item);
    changed_.notify_all();
  }
  /// Those that came so far.
  std::vector<T> items() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_;
  }
  std::optional<T> wait_for(const std::function<bool(const T&)>& wanted,
                            std::chrono::milliseconds time = std::chrono::milliseconds(15000)) {
    std::unique_lock<std::mutex> lock(mutex_);
    std::optional<T> found;
    std::size_t next = 0;
    changed_.wait_for(lock, time, [&] {
      for (; next < items_.size() && !found; ++next) {
        if (wanted(items_[next])) found = items_[next];
      }
      return found.has_value();
    });
    return found;
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.clear();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> items_;
};

}  // namespace bpa::support
