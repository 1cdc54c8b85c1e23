// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

bool within_tolerance(const Hypothesis& hypothesis, const Pose& truth,
                      const SymmetryGroup& symmetry) {
  const PoseError error = pose_error(to_pose(hypothesis.camera_from_object), truth, symmetry);
  return error.position < 0.025 && error.angle < M_PI / 16;
}

// The place of the first hypothesis that is right; the number of all where none is.
std::size_t first_right(const std::vector<Hypothesis>& hypotheses, const Pose& truth,
                        const SymmetryGroup& symmetry) {
  const auto found = std::find_if(
      hypotheses.begin(), hypotheses.end(),
      [&](const Hypothesis& hypothesis) { return within_tolerance(hypothesis, truth, symmetry); });
  return static_cast<std::size_t>(found - hypotheses.begin());
}

void expect_same(const std::vector<Hypothesis>& a, const std::vector<Hypothesis>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].camera_from_object.rotation, b[i].camera_from_object.rotation);
    ASSERT_EQ(a[i].camera_from_object.translation, b[i].camera_from_object.translation);
    ASSERT_EQ(a[i].score, b[i].score);
  }
}

void expect_best_first(const std::vector<Hypothesis>& hypotheses) {
  EXPECT_TRUE(std::is_sorted(hypotheses.begin(), hypotheses.end(),
                             [](const auto& a, const auto& b) { return a.score > b.score; }));
}

class Hypotheses : public test::LScene {};

TEST_F(Hypotheses, SomeAreRightAndClustersBringThemForward) {
  const SceneFeatures scene = features_of(everything());
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    HypothesisOptions options;
    options.seed = seed;
    const auto of_l = sample_hypotheses(scene, *l_, options);
    expect_best_first(of_l);
    EXPECT_LE(of_l.size(), static_cast<std::size_t>(options.max_kept));
    ASSERT_LT(first_right(of_l, l_truth_, l_->symmetry), of_l.size());
    const auto clusters = cluster_hypotheses(scene, *l_, of_l, 50);
    expect_best_first(clusters);
    EXPECT_LE(clusters.size(), 50u);
    EXPECT_LT(first_right(clusters, l_truth_, l_->symmetry), 5u);
  }
}

TEST_F(Hypotheses, SymmetryIsTakenIntoAccount) {
  const SceneFeatures scene = features_of(everything());
  const auto sampled = sample_hypotheses(scene, *brick_, {});
  const auto clusters = cluster_hypotheses(scene, *brick_, sampled, 50);
  EXPECT_LT(first_right(clusters, brick_truth_, brick_->symmetry), 5u);
  // As if the brick had none: each of the four ways it can lie makes a cluster of its own.
  const auto plain = test::model_of(test::box_mesh(test::kBrickHalf), "plain", 2);
  EXPECT_GT(cluster_hypotheses(scene, *plain, sampled, 1000).size(),
            cluster_hypotheses(scene, *brick_, sampled, 1000).size());
}

TEST_F(Hypotheses, NoiseDoesNotHideThem) {
  const SceneFeatures scene = features_of(everything(), 1);
  const auto clusters = cluster_hypotheses(scene, *l_, sample_hypotheses(scene, *l_, {}), 100);
  EXPECT_LT(first_right(clusters, l_truth_, l_->symmetry), 20u);
}

TEST_F(Hypotheses, EachSourceAloneFindsTheL) {
  const SceneFeatures scene = features_of(everything());
  SceneFeatures without_pairs = scene;
  without_pairs.pairs = scene_pairs(scene.coarse, {}, 0.1f, 1);
  const auto by_features = sample_hypotheses(without_pairs, *l_, {});
  for (const Hypothesis& hypothesis : by_features) {
    ASSERT_EQ(hypothesis.source, Hypothesis::Source::feature);
  }
  EXPECT_LT(first_right(by_features, l_truth_, l_->symmetry), by_features.size());
  SceneFeatures without_keypoints = scene;
  without_keypoints.keypoints.clear();
  without_keypoints.fpfh.clear();
  const auto by_pairs = sample_hypotheses(without_keypoints, *l_, {});
  for (const Hypothesis& hypothesis : by_pairs) {
    ASSERT_EQ(hypothesis.source, Hypothesis::Source::pairs);
  }
  EXPECT_LT(first_right(by_pairs, l_truth_, l_->symmetry), by_pairs.size());
}

TEST_F(Hypotheses, SameSeedSameHypotheses) {
  const SceneFeatures one = features_of(everything(), 1, 1);
  const SceneFeatures many = features_of(everything(), 1, 8);
  EXPECT_EQ(one.fpfh, many.fpfh);
  EXPECT_EQ(one.keypoints, many.keypoints);
  const auto first = sample_hypotheses(one, *l_, {});
  expect_same(first, sample_hypotheses(many, *l_, {}));
  expect_same(cluster_hypotheses(one, *l_, first, 100), cluster_hypotheses(many, *l_, first, 100));
}

TEST_F(Hypotheses, OfAnEmptyTableThereAreNone) {
  const SceneFeatures scene = features_of(table_only());
  const auto sampled = sample_hypotheses(scene, *l_, {});
  EXPECT_TRUE(cluster_hypotheses(scene, *l_, {}, 10).empty());
  EXPECT_LT(sampled.size(), 50u);
}

}  // namespace
}  // namespace bpa
