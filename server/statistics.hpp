// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result/interpretation.hpp"
#include "server/convert/frames.hpp"

namespace bpa::server {

/// What the server counted since it started.
struct Counts {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_dropped = 0;   ///< A newer one took the place.
  std::uint64_t frames_fused = 0;     ///< Searched only as a part of a newer one.
  std::uint64_t fusion_restarts = 0;  ///< Frames were combined anew: the camera or scene changed.
  std::uint64_t frames_rejected = 0;  ///< Broke a rule.
  std::uint64_t frames_failed = 0;    ///< Legal, but the search failed.
  std::uint64_t requests_served = 0;
  std::uint64_t requests_refused = 0;  ///< Busy, too late or not legal.
};

/// The server's memory of how it is doing. Thread-safe.
class Statistics {
 public:
  /// Adds to one counter: add(&Counts::frames_dropped).
  void add(std::uint64_t Counts::*counter) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++(counts_.*counter);
  }
  /// Counts a frame that came in, and remembers when.
  void add_frame();
  /// Since the last frame came in; nothing before the first.
  std::optional<double> seconds_since_frame() const;
  /// Counts a rejected frame.
  void add_rejection(RejectionCause cause);
  void add_timings(const SceneInterpretations& result);
  /// Counts it, and remembers why.
  void add_fusion_restart(const std::string& reason);

  Counts counts() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return counts_;
  }
  /// The last reason; empty before the first.
  std::string fusion_restart() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return fusion_restart_;
  }
  /// The causes of rejection that occurred, with their counts.
  std::vector<std::pair<std::string, std::uint64_t>> rejections() const;
  /// Medians over the last 50 frames, in the order of the stages, "total" last.
  std::vector<StageTiming> median_timings() const;
  /// Median of the whole search; 0 before the first.
  double median_total_ms() const;
  /// The shortest of the last searches; 0 before the first.
  double shortest_total_ms() const;
  /// After a change that makes searches longer or shorter.
  void forget_timings();

 private:
  mutable std::mutex mutex_;
  Counts counts_;
  std::optional<std::chrono::steady_clock::time_point> last_frame_;
  std::array<std::uint64_t, std::size(kRejectionCauses)> rejections_{};
  std::string fusion_restart_;
  std::vector<std::pair<std::string, std::deque<double>>> stages_;
  std::deque<double> totals_;
};

/// Resident memory of this process in bytes; 0 when unknown.
std::uint64_t resident_bytes();

}  // namespace bpa::server
