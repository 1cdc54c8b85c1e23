// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/search_plan.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(SearchPlan, ABudgetRaisesTheLimitsOfLogOdds) {
  const DetectOptions before;
  DetectOptions after;
  raise_limits(after);
  EXPECT_GT(after.check.min_ranked_score, before.check.min_ranked_score);
  EXPECT_GT(after.cluster.min_cluster_score, before.cluster.min_cluster_score);
  EXPECT_GT(after.refine.min_aligned_score, before.refine.min_aligned_score);
  EXPECT_LT(after.check.max_in_library, before.check.max_in_library);
  EXPECT_EQ(after.cluster.max_in_library, before.cluster.max_in_library);
}

TEST(SearchPlan, WithoutColoursMoreIsTried) {
  const DetectOptions before;
  DetectorOptions changed;
  search_without_colors(changed);
  const DetectOptions& after = changed.detect;
  EXPECT_GT(after.sample.peaks_per_reference, before.sample.peaks_per_reference);
  EXPECT_GT(after.sample.rim_peaks_per_reference, before.sample.rim_peaks_per_reference);
  EXPECT_GT(after.check.max_in_library, before.check.max_in_library);
  EXPECT_GT(after.cluster.max_in_library, before.cluster.max_in_library);
  EXPECT_GT(after.refine.max_in_library, before.refine.max_in_library);
  EXPECT_LT(after.cluster.min_cluster_score, before.cluster.min_cluster_score);
  DetectorOptions no_rims;
  no_rims.detect.sample.rim_peaks_per_reference = 0;
  search_without_colors(no_rims);
  EXPECT_EQ(no_rims.detect.sample.rim_peaks_per_reference, 0);
}

TEST(SearchPlan, ManyModelsShareTheWork) {
  for (const auto& [models, step] : {std::pair{1, 1}, {21, 1}, {119, 1}, {120, 2}, {200, 3}}) {
    DetectorOptions options;
    share_among_models(models, options);
    EXPECT_EQ(options.rounds.step_without_sign, step);
  }
  DetectorOptions set;
  set.rounds.step_without_sign = 3;
  share_among_models(200, set);
  EXPECT_EQ(set.rounds.step_without_sign, 3);
}

TEST(SearchPlan, MoreCandidatesOfManyModelsGoOn) {
  for (const auto& [models, most] : {std::pair{1, 500}, {24, 500}, {192, 1000}, {648, 1500}}) {
    DetectorOptions options;
    options.detect.check.max_in_library = options.detect.cluster.max_in_library =
        options.detect.refine.max_in_library = 500;
    share_among_models(models, options);
    EXPECT_EQ(options.detect.check.max_in_library, most);
    EXPECT_EQ(options.detect.cluster.max_in_library, most);
    EXPECT_EQ(options.detect.refine.max_in_library, most);
  }
}

TEST(SearchPlan, NoBudgetShortensNothing) {
  DetectorOptions options;
  EXPECT_EQ(shorten_preparation(0, 2, options), 1);
  EXPECT_EQ(shorten_preparation(1000, 2, options), 1);
  EXPECT_EQ(options.features.max_keypoints, DetectorOptions().features.max_keypoints);
  EXPECT_EQ(options.surface.max_width, DetectorOptions().surface.max_width);
  EXPECT_TRUE(options.features.use_outline);
}

TEST(SearchPlan, SmallerBudgetsPrepareLess) {
  double before = 0;
  int keypoints = 0, width = 0;
  for (const double budget_ms : {20, 50, 70, 139, 140, 150, 200, 500}) {
    DetectorOptions options;
    const double share = shorten_preparation(budget_ms, 2, options);
    EXPECT_GT(share, 0);
    EXPECT_GE(share, before) << budget_ms;
    EXPECT_GE(options.features.max_keypoints, keypoints) << budget_ms;
    EXPECT_GE(options.surface.max_width, width) << budget_ms;
    before = share;
    keypoints = options.features.max_keypoints;
    width = options.surface.max_width;
  }
}

TEST(SearchPlan, OneThreadPreparesLess) {
  DetectorOptions one, two;
  EXPECT_LT(shorten_preparation(150, 1, one), shorten_preparation(150, 2, two));
  EXPECT_LT(one.surface.max_width, two.surface.max_width);
}

TEST(SearchPlan, DetailsAreLeftOutWhereTimeIsShort) {
  EXPECT_TRUE(details_fit(10, std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(details_fit(10, 200));
  EXPECT_FALSE(details_fit(10, 50));
  EXPECT_FALSE(details_fit(50, 200));
}

TEST(SearchPlan, AWholeRoundHasItsOptions) {
  const DetectorOptions options, whole = sized_round(options, 1);
  EXPECT_EQ(whole.features.max_references, options.features.max_references);
  EXPECT_EQ(whole.features.round_keypoints, options.features.round_keypoints);
  EXPECT_EQ(whole.detect.check.max_in_library, options.detect.check.max_in_library);
  EXPECT_EQ(whole.detect.cluster.max_in_library, options.detect.cluster.max_in_library);
  EXPECT_EQ(whole.detect.refine.max_in_library, options.detect.refine.max_in_library);
  EXPECT_EQ(sized_final(options.detect, 1).flat.max_laid, options.detect.flat.max_laid);
}

TEST(SearchPlan, SmallSharesLookAtLessButAtSomething) {
  const DetectorOptions options, half = sized_round(options, 0.5);
  EXPECT_EQ(half.features.max_references, (options.features.max_references + 1) / 2);
  EXPECT_EQ(half.detect.refine.max_in_library, options.detect.refine.max_in_library / 2);
  const DetectorOptions least = sized_round(options, 1e-6);
  EXPECT_EQ(least.features.max_references, 1);
  EXPECT_EQ(least.detect.check.max_in_library, 1);
  EXPECT_EQ(sized_final(options.detect, 1e-6).climb.max_climbed, 1);
}

TEST(SearchPlan, WhatIsOffStaysOff) {
  DetectorOptions options;
  options.features.max_references = 0;
  options.detect.flat.max_laid = 0;
  EXPECT_EQ(sized_round(options, 0.5).features.max_references, 0);
  EXPECT_EQ(sized_final(options.detect, 0.5).flat.max_laid, 0);
}

TEST(SearchPace, MoreTimeIsALargerRound) {
  const SearchPace pace(60, 21);
  double before = 0;
  for (double milliseconds = 0; milliseconds < 2000; milliseconds += 10) {
    const double share = pace.share_of_round(milliseconds);
    EXPECT_GE(share, before);
    EXPECT_LE(share, 1);
    EXPECT_TRUE(share == 0 || share >= kSmallestRound) << share;
    before = share;
  }
  EXPECT_EQ(before, 1);
}

TEST(SearchPace, MoreModelsAreASmallerRoundOfEach) {
  EXPECT_GT(SearchPace(60, 5).share_of_round(100), SearchPace(60, 21).share_of_round(100));
  EXPECT_GT(SearchPace(60, 5).share_of_final(20), SearchPace(60, 21).share_of_final(20));
}

TEST(SearchPace, LearnsFromRounds) {
  SearchPace pace(60, 21);
  pace.took(0.1, 50);
  EXPECT_NEAR(pace.share_of_round(100), 0.2, 1e-9);
  pace.took(0.2, 50);
  EXPECT_NEAR(pace.share_of_round(100), 0.4, 1e-9);
}

}  // namespace
}  // namespace bpa
