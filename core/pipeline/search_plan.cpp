// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/search_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bpa {
namespace {

// What a small budget leaves of the preparation. Budgets and sizes are chosen by hand on real and
// simulated frames of 640 x 480, on two cores of a 2.5 GHz EPYC: a whole preparation takes 60 ms.
struct Shortened {
  double below_ms;  // of the budget
  int max_width;    // pixels
  double share;     // of the whole preparation's time; measured
};
constexpr int kAnyWidth = 1 << 20;
constexpr Shortened kShortened[] = {{70, 160, 0.3}, {140, 240, 0.4}, {200, kAnyWidth, 0.75}};
constexpr int kFewKeypoints = 200;          // with any of them
constexpr double kOneThread = 0.55;         // what two do in a time, one does in so much of it
constexpr double kRestOfPreparation = 5;    // times the surface; measured
constexpr double kTimeOfPreparation = 0.7;  // of what is left after the surface, at most; by hand

// Measured with 21 models: of the whole preparation's time, for each model. Not the mean of all
// frames but some 10 % more than YCB-Video's 0.085, and its 0.157 (18 models in piles: 0.069 and
// 0.063), as a late answer is worse than a little less of the search. Rounds are shorter since
// pairs vote by colour (bb0343a). But with 0.08 and 0.11, 266/379 and 263/379 objects of YCB-Video
// and of seeds 100 and 777 are found in 0.5 s by two seeds, and with these 269/379 and 268/379.
constexpr double kRoundTime = 0.095, kFinalTime = 0.16;

// The limits of quick scores before the last alignment.
std::array<double*, 3> limits_of(DetectOptions& options) {
  return {&options.check.min_ranked_score, &options.cluster.min_cluster_score,
          &options.refine.min_aligned_score};
}

int part_of(int count, double share) {
  return std::min(count, std::max(1, static_cast<int>(std::lround(share * count))));
}

// How many candidates of all models go on, stage by stage.
std::array<int*, 3> most_in_library(DetectOptions& options) {
  return {&options.check.max_in_library, &options.cluster.max_in_library,
          &options.refine.max_in_library};
}

}  // namespace

double shorten_preparation(double budget_ms, int num_threads, DetectorOptions& options) {
  if (!(budget_ms > 0)) return 1;
  if (num_threads == 1) budget_ms *= kOneThread;
  for (const Shortened& shortened : kShortened) {
    if (budget_ms >= shortened.below_ms) continue;
    options.surface.max_width = std::min(options.surface.max_width, shortened.max_width);
    options.features.max_keypoints = std::min(options.features.max_keypoints, kFewKeypoints);
    leave_out_details(options.features);
    return shortened.share;
  }
  return 1;
}

bool details_fit(double surface_ms, double milliseconds_left) {
  return kRestOfPreparation * surface_ms <= kTimeOfPreparation * milliseconds_left;
}

void search_without_colors(DetectorOptions& detector) {
  // Near what was chosen on simulated piles before colours counted; kLower of log odds.
  constexpr int kPeaks = 5, kRimPeaks = 2, kChecked = 3, kOthers = 2;
  constexpr double kLower = 1;
  DetectOptions& options = detector.detect;
  SampleOptions& sample = options.sample;
  sample.peaks_per_reference = std::max(sample.peaks_per_reference, kPeaks);
  if (sample.rim_peaks_per_reference > 0) {
    sample.rim_peaks_per_reference = std::max(sample.rim_peaks_per_reference, kRimPeaks);
  }
  options.check.max_in_library *= kChecked;
  options.cluster.max_in_library *= kOthers;
  options.refine.max_in_library *= kOthers;
  for (double* limit : limits_of(options)) *limit -= kLower;
  options.refine.min_refined_score -= kLower;
}

void share_among_models(int models, DetectorOptions& options) {
  // For how many whole samples are looked at, and for how many the limits are. With 200 models,
  // limits 2.9 times as high, and one in 2, 3 and 8 points, three seeds of the search find 420/612,
  // 412/612 and 388/612 objects of seed 777, in 2.5, 2.4 and 1.9 times as long as 20 models take.
  constexpr int kWholeModels = 60, kLimitedModels = 24;
  if (options.rounds.step_without_sign == 0) {
    options.rounds.step_without_sign = std::max(1, models / kWholeModels);
  }
  constexpr int kMost = 1'000'000;  // that the options allow
  // Twice as many for eight times the models. With 200 models, one in 3 points, and limits 1.5, 2
  // and 2.9 times as high: 400/612, 403/612 and 412/612, in 2.0, 2.1 and 2.4 times as long.
  const double more = std::cbrt(std::max(1.0, static_cast<double>(models) / kLimitedModels));
  for (int* most : most_in_library(options.detect)) {
    *most = std::min(static_cast<int>(std::lround(more * *most)), kMost);
  }
}

void leave_out_details(SceneFeatureOptions& options) {
  options.use_outline = options.use_flat_regions = false;
}

DetectorOptions sized_round(const DetectorOptions& options, double share) {
  DetectorOptions out = options;
  for (int* size : {&out.features.max_references, &out.features.round_keypoints}) {
    *size = part_of(*size, share);
  }
  for (int* most : most_in_library(out.detect)) *most = part_of(*most, share);
  return out;
}

void raise_limits(DetectOptions& options) {
  // Chosen with 0.5 s a frame. At 29e0ac6, 141/204 and 99/143 objects of seeds 777 and 100 are
  // found, and with 1 and all of the checked 141/204 and 98/143.
  constexpr double kHigher = 2, kOfChecked = 0.6;  // log odds; share of those that are checked
  for (double* limit : limits_of(options)) *limit += kHigher;
  options.check.max_in_library = part_of(options.check.max_in_library, kOfChecked);
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
