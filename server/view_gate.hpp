// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bpa::server {

/// Brings frames of several cameras together that were taken at nearly one time. `Frame` has
/// stamp_ns and frame_id. Thread-safe.
template <class Frame>
class ViewGate {
 public:
  /// `cameras` are frame_ids; `tolerance_ns` is the largest difference of stamps.
  ViewGate(std::vector<std::string> cameras, std::int64_t tolerance_ns)
      : cameras_(std::move(cameras)), tolerance_ns_(tolerance_ns), latest_(cameras_.size()) {}

  /// Whether frames of this camera are to be added.
  bool takes(const std::string& frame_id) const {
    return std::ranges::count(cameras_, frame_id) > 0;
  }

  /// One frame of each camera, in their order, where this one completes them. `displaced` is
  /// increased for each frame that will not be used.
  std::optional<std::vector<Frame>> add(Frame frame, std::size_t& displaced) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto camera =
        static_cast<std::size_t>(std::ranges::find(cameras_, frame.frame_id) - cameras_.begin());
    if (camera == cameras_.size()) return std::nullopt;
    displaced += latest_[camera].has_value();
    latest_[camera] = std::move(frame);
    std::int64_t newest = latest_[camera]->stamp_ns, oldest = newest;
    for (const std::optional<Frame>& one : latest_) {
      if (!one) return std::nullopt;
      newest = std::max(newest, one->stamp_ns);
      oldest = std::min(oldest, one->stamp_ns);
    }
    if (newest - oldest > tolerance_ns_) return std::nullopt;
    std::vector<Frame> views;
    for (std::optional<Frame>& one : latest_) views.push_back(*std::exchange(one, std::nullopt));
    return views;
  }

 private:
  const std::vector<std::string> cameras_;
  const std::int64_t tolerance_ns_;
  std::mutex mutex_;
  std::vector<std::optional<Frame>> latest_;  ///< Of each camera, since the last views.
};

}  // namespace bpa::server
