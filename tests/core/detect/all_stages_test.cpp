// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/all_stages.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"
#include "core/score/rival_poses.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa::detect {
namespace {

class SingleObject : public test::LScene {};

TEST_F(SingleObject, BestPlacementIsTheTruth) {
  for (const float noise : {0.0f, 1.0f}) {
    const SceneFeatures scene = features_of(everything(), noise);
    for (const auto& [model, truth] : {std::pair(l_, l_truth_), std::pair(brick_, brick_truth_)}) {
      const auto candidates = test::run_all_stages(Search(scene, *model));
      ASSERT_FALSE(candidates.empty()) << model->name;
      const PoseError error = pose_error(candidates[0].pose(), truth, model->symmetry);
      EXPECT_LT(error.position, 0.004) << model->name;
      EXPECT_LT(error.angle, 0.05) << model->name;
    }
  }
}

TEST_F(SingleObject, PlacementsAreRankedAndDistinct) {
  const SceneFeatures scene = features_of(everything(), 1);
  DetectPlan plan;
  plan.limits[score::Limit::selected] = -20;
  const auto candidates = test::run_all_stages(Search(scene, *l_, plan));
  ASSERT_GT(candidates.size(), 1u);
  EXPECT_LE(candidates.size(), static_cast<std::size_t>(plan.select.max_placements));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    EXPECT_EQ(c.model, l_.get());
    EXPECT_GE(c.score, plan.limits[score::Limit::selected]);
    EXPECT_LE(c.score, candidates[i > 0 ? i - 1 : 0].score);
    EXPECT_NEAR(c.probability, 1 / (1 + std::exp(-c.score)), 1e-9);
    EXPECT_TRUE(std::is_sorted(c.explained.begin(), c.explained.end()));
    for (std::size_t j = 0; j < i; ++j) {
      const PoseError error = pose_error(c.pose(), candidates[j].pose());
      EXPECT_FALSE(error.position < 0.004 && error.angle < 0.05) << i << " repeats " << j;
    }
  }
  plan.select.max_placements = 1;
  EXPECT_EQ(test::run_all_stages(Search(scene, *l_, plan)).size(), 1u);
  plan.limits[score::Limit::selected] = 1e9;
  EXPECT_TRUE(test::run_all_stages(Search(scene, *l_, plan)).empty());
}

TEST_F(SingleObject, SameSeedSameCandidates) {
  const SceneFeatures one = features_of(everything(), 1, 1);
  const SceneFeatures many = features_of(everything(), 1, 8);
  const auto a = test::run_all_stages(Search(one, *l_));
  const auto b = test::run_all_stages(Search(many, *l_));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pose().translation, b[i].pose().translation);
    EXPECT_EQ(a[i].pose().rotation.coeffs(), b[i].pose().rotation.coeffs());
    EXPECT_EQ(a[i].score, b[i].score);
    EXPECT_EQ(a[i].explained, b[i].explained);
  }
}

TEST_F(SingleObject, TheTraceAccountsForEveryHypothesisAndChangesNothing) {
  const SceneFeatures scene = features_of(everything(), 1);
  ObjectTrace trace;
  const auto traced = test::run_all_stages(Search(scene, *l_), &trace);
  const auto plain = test::run_all_stages(Search(scene, *l_));
  ASSERT_EQ(traced.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(traced[i].pose().translation, plain[i].pose().translation);
    EXPECT_EQ(traced[i].score, plain[i].score);
  }
  std::vector<std::string> names;
  for (std::size_t s = 0; s < trace.stages.size(); ++s) {
    const TraceStage& stage = trace.stages[s];
    names.emplace_back(stage.name);
    EXPECT_GE(stage.milliseconds, 0) << stage.name;
    std::size_t all = stage.poses.size();
    for (const Rejected& dropped : stage.rejected) {
      EXPECT_FALSE(dropped.poses.empty()) << stage.name << ": " << dropped.reason;
      all += dropped.poses.size();
    }
    if (s == 0) continue;
    const std::size_t before = trace.stages[s - 1].poses.size();
    if (names.back() == "turn") {
      EXPECT_GE(stage.poses.size(), before);
      EXPECT_GT(all, before) << "an L has near symmetries: added, or there already";
    } else {
      EXPECT_EQ(all, before) << stage.name;
    }
  }
  EXPECT_EQ(names, (std::vector<std::string>{"sample", "check", "correct", "cluster", "round_two",
                                             "refine", "score", "climb", "turn", "lay", "compare",
                                             "select"}));
  EXPECT_GT(trace.stages[0].poses.size(), 1000u);
  EXPECT_TRUE(trace.stages[2].rejected.empty()) << "a correction rejects nothing";
  ASSERT_EQ(trace.stages.back().poses.size(), plain.size());
  EXPECT_LT((trace.stages.back().poses[0].translation.cast<double>() - plain[0].pose().translation)
                .norm(),
            1e-6);
  // What was dropped over free space does hang in it: seen again, with all points.
  for (const Rejected& dropped : trace.stages[1].rejected) {
    if (dropped.reason != "too much in free space") continue;
    int hanging = 0;
    for (const FastPose& pose : dropped.poses) {
      const score::CheckTolerance tolerance{0.010, CheckOptions().free_depth_m, 0.75};
      const score::PoseCheck check =
          score::check_pose(scene.image, l_->index->check, pose, {1024}, tolerance);
      hanging += check.free_space > 0;
    }
    EXPECT_GT(hanging, 0.98 * static_cast<double>(dropped.poses.size()));
  }
}

TEST_F(SingleObject, MeasuresNoFurtherThanTheFirstComponentsAreProbable) {
  const SceneFeatures scene = features_of(everything(), 1);
  const score::FeaturePlaces places(*l_);
  const score::ScoreLayer& layer = score::default_score_layers().round_three;
  const score::Limits limits = DetectPlan().limits;
  RandomStream random(5);
  int stopped = 0, measured = 0;
  for (int i = 0; i < 200; ++i) {
    Pose pose = l_truth_;
    for (double& x : pose.translation) x += 0.02 * (i % 4) * random.uniform(-1, 1);
    score::Evidence whole(scene, places, pose);
    const score::ScoreValues values = measure(whole, score::Round::three);
    double log_odds = layer.bias - 1;
    bool probable = true;
    for (std::size_t k = 0; k < values.size(); ++k) {
      log_odds += layer.components[k].at(values[k]);
      probable &= log_odds >= limits.components[k];
    }
    score::Evidence again(scene, places, pose);
    const auto some = score::measure_while_probable(again, layer, -1, limits);
    ASSERT_EQ(some.has_value(), probable) << i;
    ++(probable ? measured : stopped);
    if (!some) continue;
    EXPECT_NEAR(layer.log_odds(*some), layer.log_odds(values), 1e-12);
  }
  EXPECT_GT(stopped, 50);
  EXPECT_GT(measured, 50);
}

TEST_F(SingleObject, StoppingEarlyLosesNoProbablePlacement) {
  const SceneFeatures scene = features_of(everything(), 1);
  DetectPlan plan;
  plan.limits[score::Limit::selected] = -5;
  for (const auto& model : {l_, brick_}) {
    plan.score.stop_early = true;
    const auto early = test::run_all_stages(Search(scene, *model, plan));
    plan.score.stop_early = false;
    const auto whole = test::run_all_stages(Search(scene, *model, plan));
    ASSERT_FALSE(whole.empty()) << model->name;
    ASSERT_EQ(early.size(), whole.size()) << model->name;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(early[i].pose().translation, whole[i].pose().translation) << model->name;
      EXPECT_EQ(early[i].score, whole[i].score) << model->name;
    }
  }
}

TEST_F(SingleObject, WithoutRoundThreeItsComponentsAreNotKnownAndCountNothing) {
  const SceneFeatures scene = features_of(everything(), 1);
  DetectOptions options;
  options.score.use_round_three = false;
  const auto candidates = test::run_all_stages(Search(scene, *l_, options));
  ASSERT_FALSE(candidates.empty());
  EXPECT_LT(pose_error(candidates[0].pose(), l_truth_, l_->symmetry).position, 0.01);
  const std::set<std::string> third = {"edge_likelihood",
                                       "occlusion_edge",
                                       "random_walk",
                                       "segment",
                                       "segment_affinity",
                                       "fpfh",
                                       "color",
                                       "tint",
                                       "exposure",
                                       "texture",
                                       "texture_evidence",
                                       "below",
                                       "gap",
                                       "balance",
                                       "silhouette",
                                       "silhouette_contrast",
                                       "rivals",
                                       "rivals_color",
                                       "hidden_by_unknown",
                                       "left_over",
                                       "copies",
                                       "relative_exposure"};
  for (const Candidate& candidate : candidates) {
    const score::ScoreLayer& layer = score::default_score_layers().round_two;
    double sum = layer.bias;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
      const std::string name(score::kScoreComponents[i].name);
      const bool skip = third.contains(name);
      EXPECT_EQ(std::isnan(candidate.values[i]), skip) << name;
      left_out += skip;
      if (!skip) sum += layer.components[i].at(candidate.values[i]);
    }
    EXPECT_EQ(left_out, third.size());
    EXPECT_NEAR(candidate.score, sum, 1e-9);
    for (const ScoreComponent& component : to_placement(candidate).components) {
      EXPECT_FALSE(third.contains(component.name)) << component.name;
    }
  }
}

TEST_F(SingleObject, OfPosesInOnePlaceTheBestIsBehindNone) {
  const SceneFeatures scene = features_of(everything(), 1);
  DetectPlan plan;
  plan.limits[score::Limit::rival_behind] = -1000;
  plan.limits[score::Limit::compared] = -1000;
  const auto candidates = test::run_all_stages(Search(scene, *l_, plan));
  ASSERT_FALSE(candidates.empty());
  EXPECT_LT(pose_error(candidates[0].pose(), l_truth_, l_->symmetry).position, 0.01);
  EXPECT_GT(candidates[0].values[score::component("rivals")], -10);
  const score::PredictedSurface first =
      score::predict_whole_surface(scene.image, *l_, candidates[0].pose());
  int behind = 0;
  for (const Candidate& c : candidates) {
    const double distance = (c.pose().translation - candidates[0].pose().translation).norm();
    if (distance > tolerance::kSamePlace * l_->diameter ||
        std::isnan(c.values[score::component("rivals")]))
      continue;
    EXPECT_LE(c.values[score::component("rivals")], 0);
    const score::PredictedSurface other = score::predict_whole_surface(scene.image, *l_, c.pose());
    EXPECT_LE(
        score::depth_evidence(scene.image, other, first, disagreement(scene.image, other, first)),
        10)
        << "better than what is called the best";
    behind += c.values[score::component("rivals")] < -30;
  }
  EXPECT_GT(behind, 0);
}

TEST_F(SingleObject, EmptyTableHoldsNothingProbable) {
  const SceneFeatures scene = features_of(table_only());
  for (const Candidate& c : test::run_all_stages(Search(scene, *l_))) {
    EXPECT_LT(c.probability, 0.5);
  }
}

TEST_F(SingleObject, UncertaintyIsReportedInBothForms) {
  const SceneFeatures scene = features_of(everything(), 1);
  const auto candidates = test::run_all_stages(Search(scene, *l_));
  ASSERT_FALSE(candidates.empty());
  const Placement placement = to_placement(candidates[0]);
  EXPECT_EQ(placement.model, "l");
  EXPECT_EQ(placement.model_number, 1);
  EXPECT_EQ(placement.probability, candidates[0].probability);
  EXPECT_GT(placement.visible_fraction, 0.5);
  EXPECT_GE(placement.components.size(), 5u);

  const auto& covariance = placement.covariance;
  EXPECT_EQ(covariance, covariance.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(covariance);
  EXPECT_GT(solver.eigenvalues()[0], 0);
  EXPECT_LT(std::sqrt(solver.eigenvalues()[5]), 0.1);

  // The Bingham's mode is the pose, and for small turns d about the camera's axes its logarithm
  // falls by d^T C^-1 d / 2.
  const Eigen::Vector4d mode = to_wxyz(placement.frame_from_object.rotation);
  Eigen::Matrix4d frame;
  frame << placement.orientation.axes, mode;
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix4d::Identity()).norm(), 1e-9);
  const Eigen::Matrix3d precision = covariance.bottomRightCorner<3, 3>().inverse();
  for (int k = 0; k < 20; ++k) {
    const Pose turned = test::disturbed(placement.frame_from_object, 0, 1e-3, 100u + k);
    const Eigen::Vector3d d =
        vector_from_rotation(turned.rotation * placement.frame_from_object.rotation.conjugate());
    const Eigen::Vector3d along = placement.orientation.axes.transpose() * to_wxyz(turned.rotation);
    const double logarithm = placement.orientation.concentrations.dot(along.cwiseAbs2());
    EXPECT_NEAR(logarithm, -0.5 * d.dot(precision * d), 1e-4 * std::abs(logarithm));
  }
}

}  // namespace
}  // namespace bpa::detect
