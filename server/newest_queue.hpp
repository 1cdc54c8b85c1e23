// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

namespace bpa::server {

/// A bounded first-in first-out queue for live data: when it is full, the oldest item gives way to
/// the newest. Not locked; its owner is.
template <class T>
class NewestQueue {
 public:
  /// `capacity` is at least 1.
  explicit NewestQueue(std::size_t capacity) : capacity_(capacity > 0 ? capacity : 1) {}

  /// Smaller than before: the next push makes room for one item, so that it shrinks in time.
  void set_capacity(std::size_t capacity) { capacity_ = capacity > 0 ? capacity : 1; }

  /// Adds an item; gives back the oldest one if it had to go.
  std::optional<T> push(T item) {
    std::optional<T> displaced;
    if (items_.size() >= capacity_) displaced = pop();
    items_.push_back(std::move(item));
    return displaced;
  }
  /// The oldest item; nothing when empty.
  std::optional<T> pop() {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    return item;
  }
  bool empty() const { return items_.empty(); }
  std::size_t size() const { return items_.size(); }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  std::deque<T> items_;
};

}  // namespace bpa::server
