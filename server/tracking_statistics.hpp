// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "core/base/clock.hpp"

namespace bpa::server {

/// Why a frame was not followed.
enum class Unfollowed {
  unwanted,      ///< No topic of tracks has a subscriber, or tracking is off.
  displaced,     ///< A newer frame took its place.
  other_camera,  ///< Another camera is followed.
  stale,         ///< Its stamp is not later than that of the frame before.
  rejected,      ///< It breaks a rule.
  no_transform,  ///< The camera's pose at its stamp is not known.
  failed,        ///< The tracker refused it or failed.
};

/// Names of the causes, by number.
inline constexpr const char* kUnfollowed[] = {
    "no subscriber", "displaced by newer ones",    "of another camera",  "stamp not later",
    "rejected",      "no transform of the camera", "the tracker refused"};

/// What became of the frames that came to be followed. Every frame is in `received`, and in one of
/// `followed`, `unfollowed` and `waiting`.
struct TrackingCounts {
  std::uint64_t received = 0;
  std::uint64_t followed = 0;
  std::array<std::uint64_t, std::size(kUnfollowed)> unfollowed{};
  std::uint64_t waiting = 0;
  std::uint64_t untracked_searches = 0;  ///< Results of searches whose frame was not followed.
};

/// Milliseconds of the last 1000 frames that were followed.
class Latencies {
 public:
  void add(double milliseconds) {
    values_.push_back(milliseconds);
    if (values_.size() > 1000) values_.pop_front();
  }
  bool empty() const { return values_.empty(); }
  /// The value that this part of them do not exceed: 0.5 is the median. 0 without any.
  double quantile(double part) const {
    if (values_.empty()) return 0;
    std::vector<double> sorted(values_.begin(), values_.end());
    const auto last = static_cast<double>(sorted.size() - 1);
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(part * last + 0.5);
    std::ranges::nth_element(sorted, at);
    return *at;
  }

 private:
  std::deque<double> values_;
};

}  // namespace bpa::server
