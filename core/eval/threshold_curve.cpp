// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/eval/evaluation.hpp"

namespace bpa::eval {
namespace {

constexpr int kSteps = 20;  // of the threshold, from 0 to 1

}  // namespace

// Estimates are matched by falling probability, so those above a threshold keep their match when
// the others are left out: one result gives the whole curve.
std::vector<ThresholdPoint> threshold_curve(const std::vector<FrameOutcome>& frames) {
  int instances = 0;
  for (const FrameOutcome& frame : frames) {
    instances += static_cast<int>(std::ranges::count(frame.truth, true, &TruthOutcome::counts));
  }
  std::vector<ThresholdPoint> curve;
  for (int step = 1; step < kSteps; ++step) {
    ThresholdPoint& point = curve.emplace_back();
    point.threshold = static_cast<double>(step) / kSteps;
    for (const FrameOutcome& frame : frames) {
      for (const EstimateOutcome& estimate : frame.estimates) {
        if (estimate.ignored || estimate.probability < point.threshold) continue;
        point.precision.hits += estimate.truth >= 0;
        ++point.precision.total;
      }
    }
    point.recall = {point.precision.hits, instances};
    const double false_positives = point.precision.total - point.precision.hits;
    if (!frames.empty()) {
      point.false_positives_per_frame = false_positives / static_cast<double>(frames.size());
    }
  }
  return curve;
}

double expected_calibration_error(const std::vector<ReliabilityBin>& bins) {
  double sum = 0;
  int count = 0;
  for (const ReliabilityBin& bin : bins) {
    sum += bin.correct.total * std::abs(bin.mean_probability - bin.correct.value());
    count += bin.correct.total;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace bpa::eval
