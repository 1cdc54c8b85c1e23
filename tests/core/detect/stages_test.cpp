// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/stages.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa::detect {
namespace {

bool within_tolerance(const Candidate& hypothesis, const Pose& truth,
                      const SymmetryGroup& symmetry) {
  const PoseError error = pose_error(hypothesis.pose(), truth, symmetry);
  return error.position < 0.025 && error.angle < M_PI / 16;
}

// The place of the first hypothesis that is right; the number of all where none is.
std::size_t first_right(const Candidates& hypotheses, const Pose& truth,
                        const SymmetryGroup& symmetry) {
  const auto found = std::find_if(
      hypotheses.begin(), hypotheses.end(),
      [&](const Candidate& hypothesis) { return within_tolerance(hypothesis, truth, symmetry); });
  return static_cast<std::size_t>(found - hypotheses.begin());
}

void expect_same(const Candidates& a, const Candidates& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].pose().rotation.coeffs(), b[i].pose().rotation.coeffs());
    ASSERT_EQ(a[i].pose().translation, b[i].pose().translation);
    ASSERT_EQ(a[i].score, b[i].score);
  }
}

void expect_best_first(const Candidates& hypotheses) {
  EXPECT_TRUE(std::ranges::is_sorted(hypotheses, std::greater(), &Candidate::score));
}

// Sampled and checked.
Candidates sampled_in(const SceneFeatures& scene, const ObjectModel& model,
                      std::uint64_t seed = 0) {
  const Search search(scene, model, {}, score::default_score_layers(), {}, seed);
  return check(search, sample(search, {}));
}

Candidates clusters_of(const SceneFeatures& scene, const ObjectModel& model,
                       const Candidates& checked, int most) {
  DetectOptions options;
  options.cluster.max_clusters = most;
  return cluster(Search(scene, model, options), checked);
}

class Stages : public test::LScene {};

TEST_F(Stages, SomeAreRightAndClustersBringThemForward) {
  const SceneFeatures scene = features_of(everything());
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const auto of_l = sampled_in(scene, *l_, seed);
    expect_best_first(of_l);
    EXPECT_LE(of_l.size(), static_cast<std::size_t>(CheckOptions().max_kept));
    ASSERT_LT(first_right(of_l, l_truth_, l_->symmetry), of_l.size());
    const auto clusters = clusters_of(scene, *l_, of_l, 50);
    expect_best_first(clusters);
    EXPECT_LE(clusters.size(), 50u);
    EXPECT_LT(first_right(clusters, l_truth_, l_->symmetry), 5u);
  }
}

TEST_F(Stages, QuickScoresFromTheLimitOnAreExact) {
  ModelSource painted = *brick_;
  painted.surface.colors.assign(painted.surface.size(), {200, 60, 50});
  const auto brick = make_object_model(std::move(painted)).value();
  for (const bool same_color : {true, false}) {
    SurfaceMap map = surface_map(test::render(everything(), test::kinect_camera(), 0, 8).frame, {});
    const Eigen::Vector3f rgb =
        same_color ? Eigen::Vector3f(200, 60, 50) : Eigen::Vector3f(40, 90, 180);
    ColorImages images;
    images.reduced = Image<Eigen::Vector3f>(map.width(), map.height(), rgb);
    auto planes = label_background_planes(map, {});
    const SceneFeatures scene =
        scene_features(std::move(map), std::move(planes), {}, std::move(images));
    const Search search(scene, *brick);
    ASSERT_EQ(search.color_evidence(brick_truth_) > 0, same_color);
    for (int i = 0; i < 200; ++i) {
      const Pose pose = test::disturbed(brick_truth_, 1e-4 * i, 1e-3 * i, i);
      const double score = search.quick_score(pose, 64);
      for (const double least : {score - 1, score - 0.01, score + 0.01, score + 1, score + 8}) {
        const double found = search.quick_score(pose, 64, least);
        if (score >= least) {
          EXPECT_EQ(found, score);
        } else {
          EXPECT_LT(found, least);
        }
      }
    }
  }
}

TEST_F(Stages, ScoresBelowTheLimitAreRejectedUnlessProtected) {
  const SceneFeatures scene = features_of(everything());
  const auto checked = [&](double limit) {
    DetectPlan plan;
    plan.check.max_kept = 100000;
    plan.limits[score::Limit::ranked] = limit;
    const Search search(scene, *l_, plan);
    Candidates sampled = sample(search, {});
    for (std::size_t i = 0; i < sampled.size(); i += 10) sampled[i].is_protected = true;
    return check(search, std::move(sampled));
  };
  Candidates expected = checked(-1000);
  const double limit = expected[expected.size() / 2].score;
  std::erase_if(expected, [&](const Candidate& c) { return c.score < limit && !c.is_protected; });
  EXPECT_LT(expected.back().score, limit);  // of a prior
  expect_same(checked(limit), expected);
}

TEST_F(Stages, SymmetryIsTakenIntoAccount) {
  const SceneFeatures scene = features_of(everything());
  const auto sampled = sampled_in(scene, *brick_);
  const auto clusters = clusters_of(scene, *brick_, sampled, 50);
  EXPECT_LT(first_right(clusters, brick_truth_, brick_->symmetry), 5u);
  // As if the brick had none: each of the four ways it can lie makes a cluster of its own.
  const auto plain = test::model_of(test::box_mesh(test::kBrickHalf), "plain", 2);
  EXPECT_GT(clusters_of(scene, *plain, sampled, 1000).size(),
            clusters_of(scene, *brick_, sampled, 1000).size());
}

TEST_F(Stages, NoiseDoesNotHideThem) {
  const SceneFeatures scene = features_of(everything(), 1);
  const auto clusters = clusters_of(scene, *l_, sampled_in(scene, *l_), 100);
  EXPECT_LT(first_right(clusters, l_truth_, l_->symmetry), 20u);
}

TEST_F(Stages, EachSourceAloneFindsTheL) {
  const SceneFeatures scene = features_of(everything());
  SceneFeatures without_pairs = scene;
  without_pairs.sample.pairs = {};
  SceneFeatures rims_alone = without_pairs;
  without_pairs.sample.rim_pairs = {};
  const auto by_features = sampled_in(without_pairs, *l_);
  for (const Candidate& hypothesis : by_features) {
    ASSERT_EQ(hypothesis.found_by, Source::feature);
  }
  EXPECT_LT(first_right(by_features, l_truth_, l_->symmetry), by_features.size());
  SceneFeatures without_keypoints = scene;
  without_keypoints.sample.rim_pairs = {};
  without_keypoints.sample.points.keypoints.clear();
  const auto by_pairs = sampled_in(without_keypoints, *l_);
  for (const Candidate& hypothesis : by_pairs) {
    ASSERT_EQ(hypothesis.found_by, Source::pairs);
  }
  EXPECT_LT(first_right(by_pairs, l_truth_, l_->symmetry), by_pairs.size());
  rims_alone.sample.points.keypoints.clear();
  const auto by_rims = sampled_in(rims_alone, *l_);
  EXPECT_LT(first_right(by_rims, l_truth_, l_->symmetry), by_rims.size());
}

TEST_F(Stages, SameSeedSameHypotheses) {
  const SceneFeatures one = features_of(everything(), 1, 1);
  const SceneFeatures many = features_of(everything(), 1, 8);
  EXPECT_EQ(one.fpfh, many.fpfh);
  EXPECT_EQ(one.keypoints, many.keypoints);
  const auto first = sampled_in(one, *l_);
  expect_same(first, sampled_in(many, *l_));
  expect_same(clusters_of(one, *l_, first, 100), clusters_of(many, *l_, first, 100));
}

TEST_F(Stages, OfAnEmptyTableThereAreNone) {
  const SceneFeatures scene = features_of(table_only());
  const auto sampled = sampled_in(scene, *l_);
  EXPECT_TRUE(clusters_of(scene, *l_, {}, 10).empty());
  EXPECT_LT(sampled.size(), 50u);
}

}  // namespace
}  // namespace bpa::detect
