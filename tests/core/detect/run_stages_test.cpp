// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "core/detect/stages.hpp"
#include "tests/support/all_stages.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa::detect {
namespace {

class RunStages : public test::LScene {
 protected:
  // Candidates in one place do not compete.
  static DetectPlan without_margins() {
    DetectPlan plan;
    for (const score::Limit behind : {score::Limit::checked_behind, score::Limit::clustered_behind,
                                      score::Limit::aligned_behind, score::Limit::refined_behind}) {
      plan.limits[behind] = -1000;
    }
    return plan;
  }
  static std::vector<Search> searches_in(const SceneFeatures& scene, const DetectPlan& options) {
    std::vector<Search> out;
    out.emplace_back(scene, *l_, options);
    out.emplace_back(scene, *brick_, options);
    return out;
  }
  // The stages of a round up to this one.
  static std::span<const Stage> up_to(std::string_view name) {
    const auto last = std::ranges::find(round_stages(), name, &Stage::name);
    return {round_stages().begin(), last + 1};
  }
  // The scores of all models' candidates after clustering, best first.
  static std::vector<double> clustered(const SceneFeatures& scene, int most_in_library,
                                       int num_threads) {
    DetectPlan options = without_margins();
    options.cluster.max_in_library = most_in_library;
    auto searches = searches_in(scene, options);
    std::vector<Candidates> found(2);
    run_stages(up_to("cluster"), searches, num_threads, found);
    std::vector<double> scores;
    for (const Candidates& of_model : found) {
      for (const Candidate& candidate : of_model) scores.push_back(candidate.score);
    }
    std::ranges::sort(scores, std::greater());
    return scores;
  }
};

TEST_F(RunStages, TheBestOfAllModelsGoOn) {
  const SceneFeatures scene = features_of(everything(), 1);
  const auto all = clustered(scene, 100000, 1);
  ASSERT_GT(all.size(), 20u);
  const auto few = clustered(scene, 10, 2);
  ASSERT_EQ(few.size(), 10u);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], all[i]);
}

TEST_F(RunStages, WhatIsFarBehindAnotherModelInItsPlaceIsRejected) {
  const SceneFeatures scene = features_of(everything(), 1);
  const auto found_with = [&](double margin) {
    DetectPlan options = without_margins();
    options.limits[score::Limit::clustered_behind] = -margin;
    auto searches = searches_in(scene, options);
    std::vector<Candidates> found(2);
    run_stages(up_to("cluster"), searches, 2, found);
    return found;
  };
  constexpr double kMargin = 2;
  const auto all = found_with(1000), left = found_with(kMargin);
  const auto is_far_behind = [&](const Candidate& c) {
    for (const Candidates& of_model : all) {
      for (const Candidate& other : of_model) {
        const double smaller = std::min(c.model->diameter, other.model->diameter);
        if ((other.place() - c.place()).norm() < 0.3 * smaller && other.score > c.score + kMargin) {
          return true;
        }
      }
    }
    return false;
  };
  int rejected = 0;
  for (std::size_t m = 0; m < 2; ++m) {
    std::vector<double> expected, scores;
    for (const Candidate& c : all[m]) {
      if (is_far_behind(c)) {
        ++rejected;
      } else {
        expected.push_back(c.score);
      }
    }
    for (const Candidate& c : left[m]) scores.push_back(c.score);
    EXPECT_EQ(scores, expected);
  }
  EXPECT_GT(rejected, 5);
}

TEST_F(RunStages, OneModelAfterAnotherFindsTheSameUnlessTheyCompete) {
  const SceneFeatures scene = features_of(everything(), 1);
  DetectPlan options = without_margins();
  options.check.max_in_library = options.cluster.max_in_library = options.round_two.max_in_library =
      100000;
  auto searches = searches_in(scene, options);
  std::vector<Candidates> found(2);
  run_stages(detection_stages(), searches, 2, found);
  const Candidates alone[] = {test::run_all_stages(Search(scene, *l_, options)),
                              test::run_all_stages(Search(scene, *brick_, options))};
  for (std::size_t m = 0; m < 2; ++m) {
    ASSERT_EQ(found[m].size(), alone[m].size());
    for (std::size_t i = 0; i < found[m].size(); ++i) {
      EXPECT_EQ(found[m][i].pose().translation, alone[m][i].pose().translation);
      EXPECT_EQ(found[m][i].score, alone[m][i].score);
    }
  }
}

TEST_F(RunStages, WhatPriorsSuggestGoesOnInAnyCase) {
  const SceneFeatures scene = features_of(everything(), 1);
  PosePrior prior;
  prior.model = "l";
  prior.position = PositionPrior{l_truth_.translation, 1e-4 * Eigen::Matrix3d::Identity()};
  DetectOptions options;
  options.check.max_in_library = 1;
  std::vector<Search> searches;
  searches.emplace_back(scene, *l_, options, score::default_score_layers(), std::span(&prior, 1));
  std::vector<Candidates> found(1);
  run_stages(up_to("check"), searches, 1, found);
  const auto suggested = std::ranges::count(found[0], true, &Candidate::is_protected);
  EXPECT_GT(suggested, 1);
  EXPECT_LE(std::ssize(found[0]) - suggested, 1);
}

}  // namespace
}  // namespace bpa::detect
