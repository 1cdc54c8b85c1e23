// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/statistics.hpp"

#include <algorithm>
#include <fstream>

#include <unistd.h>

namespace bpa::server {
namespace {

constexpr std::size_t kRemembered = 50;

void remember(std::deque<double>& values, double value) {
  values.push_back(value);
  if (values.size() > kRemembered) values.pop_front();
}

double median(const std::deque<double>& values) {
  if (values.empty()) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace

void Statistics::add_frame() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.frames_received;
  last_frame_ = std::chrono::steady_clock::now();
}

std::optional<double> Statistics::seconds_since_frame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!last_frame_) return std::nullopt;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - *last_frame_).count();
}

void Statistics::add_rejection(RejectionCause cause) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.frames_rejected;
  ++rejections_[static_cast<std::size_t>(cause)];
}

void Statistics::add_timings(const SceneInterpretations& result) {
  const std::lock_guard<std::mutex> lock(mutex_);
  remember(totals_, result.total_milliseconds);
  for (const StageTiming& timing : result.timings) {
    auto stage = std::find_if(stages_.begin(), stages_.end(),
                              [&](const auto& s) { return s.first == timing.stage; });
    if (stage == stages_.end()) stage = stages_.insert(stage, {timing.stage, {}});
    remember(stage->second, timing.milliseconds);
  }
}

void Statistics::add_fusion_restart(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.fusion_restarts;
  fusion_restart_ = reason;
}

std::vector<std::pair<std::string, std::uint64_t>> Statistics::rejections() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::pair<std::string, std::uint64_t>> counts;
  for (std::size_t i = 0; i < rejections_.size(); ++i) {
    if (rejections_[i] > 0) counts.emplace_back(kRejectionCauses[i], rejections_[i]);
  }
  return counts;
}

std::vector<StageTiming> Statistics::median_timings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<StageTiming> timings;
  for (const auto& [stage, values] : stages_) timings.push_back({stage, median(values)});
  if (!totals_.empty()) timings.push_back({"total", median(totals_)});
  return timings;
}

double Statistics::median_total_ms() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return median(totals_);
}

double Statistics::shortest_total_ms() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return totals_.empty() ? 0 : *std::min_element(totals_.begin(), totals_.end());
}

void Statistics::forget_timings() {
  const std::lock_guard<std::mutex> lock(mutex_);
  stages_.clear();
  totals_.clear();
}

std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  file >> total >> resident;
  return file ? resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace bpa::server
