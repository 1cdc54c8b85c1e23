// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/guarded.hpp"
#include "ros/frames.hpp"
#include "server/once.hpp"

namespace bpa::server {

/// A frame that both the search and the tracker get. It is decoded once, by the first that asks;
/// the other waits for it. Thread-safe.
class SharedFrame {
 public:
  explicit SharedFrame(Once<ros::DecodedFrame> decode) : decode_(std::move(decode)) {}

  /// The frame, or why there is none.
  const ros::DecodedFrame& get() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!frame_) {
      const Status status =
          guarded("a frame cannot be decoded", [this] { frame_.emplace(std::move(decode_)()); });
      if (!status.ok()) frame_.emplace(ros::RejectionCause::frame, status);
    }
    return *frame_;
  }

  /// The search has begun with it, so that its result is of use to the tracker.
  void set_searched() { searched_ = true; }
  bool searched() const { return searched_; }

 private:
  std::mutex mutex_;
  Once<ros::DecodedFrame> decode_;
  std::optional<ros::DecodedFrame> frame_;  ///< Never changed once it is there.
  std::atomic<bool> searched_{false};
};

}  // namespace bpa::server
