// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/search_plan.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

namespace bpa {
namespace {

SearchPlan plan_of(const SearchFacts& facts, const DetectorOptions& options = {}) {
  auto plan = plan_search(options, score::default_score_layers(), facts);
  EXPECT_TRUE(plan.ok()) << plan.status().message;
  return std::move(plan).value();
}

SearchFacts with_budget(double budget_ms) {
  return {.budget_ms = budget_ms, .costs = {.preparation_ms = 60}};
}

std::string reason(const SearchPlan& plan, const std::string& name) {
  const auto found = std::ranges::find(plan.entries, name, &PlanEntry::name);
  return found == plan.entries.end() ? "no entry" : found->reason;
}

// The numbers are those that were chosen on simulated piles.
TEST(SearchPlan, WithoutColoursMoreIsTried) {
  const detect::DetectPlan with = plan_of({}).detect, without = plan_of({.colored = false}).detect;
  EXPECT_EQ(with.sample.peaks_per_reference, 2);
  EXPECT_EQ(without.sample.peaks_per_reference, 5);
  EXPECT_EQ(with.sample.rim_peaks_per_reference, 1);
  EXPECT_EQ(without.sample.rim_peaks_per_reference, 2);
  EXPECT_EQ(with.check.max_in_library, 800);
  EXPECT_EQ(without.check.max_in_library, 2400);
  EXPECT_EQ(with.cluster.max_in_library, 180);
  EXPECT_EQ(without.cluster.max_in_library, 360);
  EXPECT_EQ(with.round_two.max_in_library, 60);
  EXPECT_EQ(without.round_two.max_in_library, 120);
  EXPECT_EQ(with.limits[score::Limit::clustered], -7);
  EXPECT_EQ(without.limits[score::Limit::clustered], -8);
}

TEST(SearchPlan, WhatTheUserSetsIsUsed) {
  DetectorOptions options;
  options.detect.sample.peaks_per_reference = 1;
  options.detect.sample.rim_peaks_per_reference = 0;
  options.detect.check.max_in_library = 500;
  const SearchPlan plan = plan_of({.models = 648, .colored = false}, options);
  EXPECT_EQ(plan.detect.sample.peaks_per_reference, 1);
  EXPECT_EQ(plan.detect.sample.rim_peaks_per_reference, 0);
  EXPECT_EQ(plan.detect.check.max_in_library, 500);
  EXPECT_EQ(reason(plan, "check.max_in_library"), "setting");
  EXPECT_EQ(reason(plan, "climb.max_climbed"), "default");
}

TEST(SearchPlan, GrowsWithTheCubeRootOfTheModels) {
  for (const auto& [models, most] : {std::pair{1, 800}, {24, 800}, {192, 1600}, {648, 2400}}) {
    EXPECT_EQ(plan_of({.models = models}).detect.check.max_in_library, most);
  }
  EXPECT_EQ(reason(plan_of({.models = 192, .colored = false}), "check.max_in_library"),
            "800 x 3 without colours x cbrt(192 models / 24)");
}

TEST(SearchPlan, RefusesAShareThatItsLayersDoNotKnow) {
  DetectorOptions options;
  options.detect.score.keep_right = 0.5;
  const auto plan = plan_search(options, score::default_score_layers(), {});
  ASSERT_FALSE(plan.ok());
  EXPECT_NE(plan.status().message.find("score.keep_right is 0.5"), std::string::npos);
  options.detect.score.keep_right = 1;
  EXPECT_EQ(plan_of({}, options).detect.limits[score::Limit::ranked],
            -std::numeric_limits<double>::infinity());
}

TEST(SearchPlan, EveryEntryHasAReason) {
  const SearchPlan plan = plan_of(with_budget(100));
  for (const PlanEntry& entry : plan.entries) {
    EXPECT_FALSE(entry.value.empty()) << entry.name;
    EXPECT_FALSE(entry.reason.empty()) << entry.name;
  }
  EXPECT_EQ(reason(plan, "features.max_keypoints"),
            "a whole preparation takes 60 ms, over half of a budget of 100 ms");
  EXPECT_EQ(reason(plan, "time.rounds"), "share of the time left");
  EXPECT_EQ(reason(plan_of({.image_width = 1920}), "surface.reduction"),
            "1920 pixels / surface.max_width, rounded up");
}

TEST(SearchPlan, TakesTheYieldOfTheColours) {
  score::ScoreLayers layers = score::default_score_layers();
  layers.yield.with_color.tries = 3;
  layers.yield.without_color.tries = 7;
  EXPECT_EQ(plan_search({}, layers, {.colored = true})->yield.tries, 3);
  EXPECT_EQ(plan_search({}, layers, {.colored = false})->yield.tries, 7);
}

TEST(SearchPlan, NoBudgetShortensNothing) {
  for (const double budget_ms : {0, 1000}) {
    const SearchPlan plan = plan_of(with_budget(budget_ms));
    EXPECT_EQ(plan.prepared_share, 1);
    EXPECT_EQ(plan.features.max_keypoints, DetectorOptions().features.max_keypoints);
    EXPECT_EQ(plan.surface.max_width, DetectorOptions().surface.max_width);
    EXPECT_TRUE(plan.features.use_outline);
  }
}

TEST(SearchPlan, SmallerBudgetsPrepareLess) {
  double before = 0;
  int keypoints = 0, width = 0;
  for (const double budget_ms : {20, 47, 48, 89, 90, 119, 120, 500}) {
    const SearchPlan plan = plan_of(with_budget(budget_ms));
    EXPECT_GT(plan.prepared_share, 0);
    EXPECT_GE(plan.prepared_share, before) << budget_ms;
    EXPECT_GE(plan.features.max_keypoints, keypoints) << budget_ms;
    EXPECT_GE(plan.surface.max_width, width) << budget_ms;
    before = plan.prepared_share;
    keypoints = plan.features.max_keypoints;
    width = plan.surface.max_width;
  }
}

TEST(SearchPlan, ASlowMachinePreparesLess) {
  SearchFacts slow = with_budget(150);
  slow.costs.preparation_ms *= 2;
  EXPECT_LT(plan_of(slow).prepared_share, plan_of(with_budget(150)).prepared_share);
}

TEST(SearchPlan, DetailsAreLeftOutWhereTimeIsShort) {
  EXPECT_TRUE(details_fit(10, std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(details_fit(10, 200));
  EXPECT_FALSE(details_fit(10, 50));
  EXPECT_FALSE(details_fit(50, 200));
}

TEST(SearchPlan, SmallSharesExamineLessButSomething) {
  const SearchPlan plan = plan_of({});
  EXPECT_EQ(round_sample(plan, 1).max_references, plan.features.max_references);
  EXPECT_EQ(round_sample(plan, 0.5).max_references, (plan.features.max_references + 1) / 2);
  EXPECT_EQ(detect::round_plan(plan.detect, 0.5).round_two.max_in_library, 30);
  EXPECT_EQ(round_sample(plan, 1e-6).max_references, 1);
  EXPECT_EQ(detect::round_plan(plan.detect, 1e-6).check.max_in_library, 1);
  EXPECT_EQ(detect::final_plan(plan.detect, 1e-6).climb.max_climbed, 1);
}

TEST(SearchPlan, WhatIsOffStaysOff) {
  DetectorOptions options;
  options.features.max_references = 0;
  options.detect.lay.max_laid = 0;
  const SearchPlan plan = plan_of({}, options);
  EXPECT_EQ(round_sample(plan, 0.5).max_references, 0);
  EXPECT_EQ(detect::final_plan(plan.detect, 0.5).lay.max_laid, 0);
}

constexpr double kSmallest = 0.06;

TEST(SearchPace, MoreTimeIsALargerRound) {
  const SearchPace pace({}, 60, 21);
  double before = 0;
  for (double milliseconds = 0; milliseconds < 2000; milliseconds += 10) {
    const double share = pace.share_of_round(milliseconds, kSmallest);
    EXPECT_GE(share, before);
    EXPECT_LE(share, 1);
    EXPECT_TRUE(share == 0 || share >= kSmallest) << share;
    before = share;
  }
  EXPECT_EQ(before, 1);
}

TEST(SearchPace, MoreModelsAreASmallerRoundOfEach) {
  const SearchPace few({}, 60, 5), many({}, 60, 21);
  EXPECT_GT(few.share_of_round(100, kSmallest), many.share_of_round(100, kSmallest));
  EXPECT_GT(few.share_of_final(20), many.share_of_final(20));
}

TEST(SearchPace, LearnsFromRounds) {
  SearchPace pace({}, 60, 21);
  pace.took(0.1, 50);
  EXPECT_NEAR(pace.share_of_round(100, kSmallest), 0.2, 1e-9);
  pace.took(0.2, 50);
  EXPECT_NEAR(pace.share_of_round(100, kSmallest), 0.4, 1e-9);
}

TEST(SearchPace, MeasuresInPreparationsOfOneModel) {
  SearchPace pace({}, 60, 20);
  EXPECT_EQ(pace.measured(0.5, 30).round_share, 0) << "no round ran";
  pace.took(0.1, 50);
  pace.took(0.2, 40);
  const Costs measured = pace.measured(0.5, 30);
  EXPECT_EQ(measured.preparation_ms, 60);
  EXPECT_NEAR(measured.round_share, 90 / 0.3 / (60 * 20), 1e-12);
  EXPECT_NEAR(measured.final_share, 60.0 / (60 * 20), 1e-12);
  EXPECT_EQ(pace.measured(0, 1).final_share, 0) << "no final stage ran";
}

TEST(CostMeter, MeasuresThisProcess) {
  CostMeter meter;
  EXPECT_GT(meter.costs(640 * 480, 1).preparation_ms, 0);
  meter.add(640 * 480, 2, {.preparation_ms = 40, .round_share = 0.2, .final_share = 0});
  EXPECT_NEAR(meter.costs(640 * 480, 2).preparation_ms, 40, 1e-9);
  EXPECT_GT(meter.costs(320 * 240, 2).preparation_ms, 0);
  EXPECT_GT(meter.costs(640 * 480, 2).round_share, Costs().round_share);
  EXPECT_EQ(meter.costs(640 * 480, 2).final_share, Costs().final_share);
}

}  // namespace
}  // namespace bpa
