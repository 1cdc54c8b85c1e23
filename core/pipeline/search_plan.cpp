// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/search_plan.hpp"

#include <algorithm>
#include <cmath>

namespace bpa {
namespace {

// Times on two cores of a 2.5 GHz EPYC, at 640 x 480: a whole preparation takes 60 ms.
constexpr double kFewKeypointsBelow_ms = 200, kSmallImageBelow_ms = 80;
constexpr double kFewKeypointsShare = 0.9, kSmallImageShare = 0.4;  // of the time; measured
constexpr int kFewKeypoints = 200, kSmallWidth = 240;               // chosen by hand

// Measured with 21 models: of the whole preparation's time, for each model. Not the mean but some
// 20 % more, as a late answer is worse than a little less of the search.
constexpr double kRoundTime = 0.5, kFinalTime = 0.2;

int part_of(int count, double share) {
  return std::min(count, std::max(1, static_cast<int>(std::lround(share * count))));
}

}  // namespace

double shorten_preparation(double budget_ms, DetectorOptions& options) {
  if (!(budget_ms > 0) || budget_ms >= kFewKeypointsBelow_ms) return 1;
  options.features.max_keypoints = std::min(options.features.max_keypoints, kFewKeypoints);
  if (budget_ms >= kSmallImageBelow_ms) return kFewKeypointsShare;
  options.surface.max_width = std::min(options.surface.max_width, kSmallWidth);
  options.features.use_outline = options.features.use_flat_regions = false;
  return kSmallImageShare;
}

DetectorOptions sized_round(const DetectorOptions& options, double share) {
  DetectorOptions out = options;
  for (int* size : {&out.features.max_references, &out.features.round_keypoints,
                    &out.detect.check.max_in_library, &out.detect.cluster.max_in_library,
                    &out.detect.refine.max_in_library}) {
    *size = part_of(*size, share);
  }
  return out;
}

DetectOptions sized_final(const DetectOptions& options, double share) {
  DetectOptions out = options;
  for (int* size : {&out.climb.max_climbed, &out.turn.max_turned, &out.turn.max_kept_turned,
                    &out.flat.max_laid, &out.flat.max_per_region}) {
    *size = part_of(*size, share);
  }
  return out;
}

SearchPace::SearchPace(double preparation_ms, int models)
    : round_ms_(kRoundTime * preparation_ms * models) {}

double SearchPace::share_of_round(double milliseconds) const {
  const double share = milliseconds / round_ms_;
  return share < kSmallestRound ? 0 : std::min(share, 1.0);
}

double SearchPace::share_of_final(double milliseconds) const {
  return std::min(1.0, milliseconds / (round_ms_ * kFinalTime / kRoundTime));
}

void SearchPace::took(double share, double milliseconds) { round_ms_ = milliseconds / share; }

}  // namespace bpa
