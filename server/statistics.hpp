// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "core/result/interpretation.hpp"
#include "ros/frames.hpp"

namespace bpa::server {

/// Requests that got no answer from their handler, or whose answer got lost.
struct RequestLosses {
  std::uint64_t refused = 0;          ///< No place in the queue of their services.
  std::uint64_t malformed = 0;        ///< No legal encoding, or too large.
  std::uint64_t lost = 0;             ///< DDS reported them lost.
  std::uint64_t replies_dropped = 0;  ///< The client went or does not listen.

  RequestLosses& operator+=(const RequestLosses& other) {
    refused += other.refused;
    malformed += other.malformed;
    lost += other.lost;
    replies_dropped += other.replies_dropped;
    return *this;
  }
};

/// What the server counted since it started.
struct Counts {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_dropped = 0;   ///< A newer one took the place, or the scene stands still.
  std::uint64_t frames_at_rest = 0;   ///< Of the dropped: of a scene that stands still.
  std::uint64_t frames_fused = 0;     ///< Searched only as a part of a newer one.
  std::uint64_t fusion_restarts = 0;  ///< Combining restarted: the camera or scene changed.
  std::uint64_t frames_rejected = 0;  ///< Broke a rule.
  std::uint64_t frames_failed = 0;    ///< Legal, but the search failed.
  std::uint64_t requests_served = 0;
  std::uint64_t requests_refused = 0;  ///< Busy, too late or not legal.
  RequestLosses losses;                ///< Of all services.
};

/// The server's memory of how it is doing. Thread-safe.
class Statistics {
 public:
  /// `clock` measures how long no frame came.
  explicit Statistics(std::shared_ptr<const WaitableClock> clock = steady_clock())
      : clock_(std::move(clock)) {}

  /// Adds to one counter: add(&Counts::frames_dropped).
  void add(std::uint64_t Counts::*counter) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++(counts_.*counter);
  }
  /// Counts a frame that came in `age_ns` after its stamp, and remembers when.
  void add_frame(std::int64_t age_ns) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counts_.frames_received;
    last_age_ns_ = age_ns;
    last_frame_ = clock_->now();
  }
  /// Since the last frame came in; nothing before the first.
  std::optional<double> seconds_since_frame() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!last_frame_) return std::nullopt;
    return std::chrono::duration<double>(clock_->now() - *last_frame_).count();
  }
  /// From the last frame's stamp until it came in; 0 before the first.
  std::int64_t last_age_ns() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_age_ns_;
  }
  /// Counts a rejected frame.
  void add_rejection(ros::RejectionCause cause) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counts_.frames_rejected;
    ++rejections_[static_cast<std::size_t>(cause)];
  }
  void add_timings(const SceneInterpretations& result) {
    const std::lock_guard<std::mutex> lock(mutex_);
    remember(totals_, result.total_milliseconds);
    remember(rounds_, static_cast<double>(result.effort.rounds));
    remember(full_scores_, static_cast<double>(result.effort.full_scores));
    for (const StageTiming& timing : result.timings) {
      auto stage = std::ranges::find(stages_, timing.stage, &Stage::first);
      if (stage == stages_.end()) stage = stages_.insert(stage, {timing.stage, {}});
      remember(stage->second, timing.milliseconds);
    }
  }
  /// Counts it, and remembers why.
  void add_fusion_restart(const std::string& reason) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counts_.fusion_restarts;
    fusion_restart_ = reason;
  }

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
  std::vector<std::pair<std::string, std::uint64_t>> rejections() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<std::pair<std::string, std::uint64_t>> counts;
    for (std::size_t i = 0; i < rejections_.size(); ++i) {
      if (rejections_[i] > 0) counts.emplace_back(ros::kRejectionCauses[i], rejections_[i]);
    }
    return counts;
  }
  /// Medians over the last 50 frames, in the order of the stages, "total" last.
  std::vector<StageTiming> median_timings() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<StageTiming> timings;
    for (const auto& [stage, values] : stages_) timings.push_back({stage, median(values)});
    if (!totals_.empty()) timings.push_back({"total", median(totals_)});
    return timings;
  }
  /// Medians of a search's counts over the last 50 frames; 0 before the first.
  std::vector<std::pair<std::string, double>> median_effort() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {{"rounds", median(rounds_)}, {"full scores", median(full_scores_)}};
  }
  /// Median of the whole search; 0 before the first.
  double median_total_ms() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return median(totals_);
  }
  /// The shortest of the last searches; 0 before the first.
  double shortest_total_ms() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return totals_.empty() ? 0 : std::ranges::min(totals_);
  }
  /// After a change that makes searches longer or shorter.
  void forget_timings() {
    const std::lock_guard<std::mutex> lock(mutex_);
    stages_.clear();
    totals_.clear();
    rounds_.clear();
    full_scores_.clear();
  }

 private:
  static constexpr std::size_t kRemembered = 50;
  using Stage = std::pair<std::string, std::deque<double>>;

  static void remember(std::deque<double>& values, double value) {
    values.push_back(value);
    if (values.size() > kRemembered) values.pop_front();
  }
  static double median(std::deque<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + values.size() / 2;
    std::ranges::nth_element(values, middle);
    return *middle;
  }

  const std::shared_ptr<const WaitableClock> clock_;
  mutable std::mutex mutex_;
  Counts counts_;
  std::optional<WaitableClock::TimePoint> last_frame_;
  std::int64_t last_age_ns_ = 0;
  std::array<std::uint64_t, std::size(ros::kRejectionCauses)> rejections_{};
  std::string fusion_restart_;
  std::vector<Stage> stages_;
  std::deque<double> totals_, rounds_, full_scores_;
};

}  // namespace bpa::server
