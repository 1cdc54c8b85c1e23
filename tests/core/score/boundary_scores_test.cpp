// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/boundary_scores.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/features/edges.hpp"
#include "core/score/likelihood.hpp"
#include "core/score/random_walk_score.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

using test::Solid;

struct Observed {
  CheckImage image;
  Image<float> edges;
};

Observed observe(const std::vector<Solid>& solids, float noise = 1) {
  const SurfaceMap map =
      surface_map(test::render(solids, test::kinect_camera(), noise, 8).frame, {});
  return {make_check_image(map), features::scene_edges(map, {}).likelihood};
}

std::vector<Solid> l_on_table() {
  return test::together({test::table(test::kCameraFromWorld)}, test::l_solids(test::kTruth));
}

// A board in front of the right part of the L.
Solid board() {
  const Eigen::Vector3d middle = test::kTruth * Eigen::Vector3d(0, 0, 0.02);
  return {Solid::Kind::box,
          {0.5, 0.5, 0.005},
          {Eigen::Quaterniond::Identity(), 0.6 * middle + Eigen::Vector3d(0.5, 0, 0)}};
}

class BoundaryScores : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    l_ = test::l_model();
    brick_ = test::brick_model();
  }
  static void TearDownTestSuite() {
    l_.reset();
    brick_.reset();
  }
  static double edge(const Observed& scene, const Pose& pose) {
    return edge_likelihood_score(scene.image, scene.edges, *l_, pose);
  }
  static double occlusion(const Observed& scene, const ObjectModel& model, const Pose& pose) {
    return occlusion_edge_score(scene.image, scene.edges,
                                predict_surface(scene.image, model, pose));
  }
  static double walk(const Observed& scene, const Pose& pose,
                     const RandomWalkOptions& options = {}) {
    return random_walk_score(scene.image, scene.edges, *l_, pose,
                             predict_surface(scene.image, *l_, pose), options);
  }
  static inline std::shared_ptr<const ObjectModel> l_, brick_;
};

TEST_F(BoundaryScores, OfAFlatEdgeImageAreItsLogarithm) {
  Observed scene = observe(test::together(l_on_table(), {board()}), 0);
  for (const float value : {1.0f, 0.5f, 0.1f, 0.0f}) {
    std::fill(scene.edges.pixels.begin(), scene.edges.pixels.end(), value);
    EXPECT_NEAR(edge(scene, test::kTruth), truncated_log(value, 0.05), 1e-6);
    EXPECT_NEAR(occlusion(scene, *l_, test::kTruth), truncated_log(value, 0.05), 1e-6);
  }
}

TEST_F(BoundaryScores, EdgesOfTheTruthAreThereAndOthersNot) {
  const Observed scene = observe(l_on_table());
  const double best = edge(scene, test::kTruth);
  EXPECT_GT(best, -0.2);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const double other = edge(scene, test::disturbed(test::kTruth, 0.02, 0.3, seed));
    EXPECT_LT(other, best);
    sum += other / 30;
  }
  EXPECT_LT(sum, best - 0.15);
}

TEST_F(BoundaryScores, HiddenEdgesDoNotCount) {
  const double open = edge(observe(l_on_table()), test::kTruth);
  const double hidden = edge(observe(test::together(l_on_table(), {board()})), test::kTruth);
  EXPECT_NEAR(hidden, open, 0.1);
}

TEST_F(BoundaryScores, EdgesWithoutAnythingToSay) {
  const Observed scene = observe(l_on_table());
  EXPECT_EQ(edge(scene, {test::kTruth.rotation, {0, 0, -1}}), -1);
  ObjectModel one_view = *l_;
  one_view.complete = false;
  EXPECT_EQ(edge_likelihood_score(scene.image, scene.edges, one_view, test::kTruth), 0);
}

TEST_F(BoundaryScores, WhatHidesPartOfItHasAnEdge) {
  EXPECT_EQ(occlusion(observe(l_on_table(), 0), *l_, test::kTruth), 0) << "nothing is hidden";
  EXPECT_GT(occlusion(observe(test::together(l_on_table(), {board()})), *l_, test::kTruth), -0.1);
  // Sunk into the table at a slant: the table hides the deep part, and nothing ends there.
  const Pose tilt{rotation_from_vector({0.6, 0, 0}), Eigen::Vector3d::Zero()};
  const Pose sunk = test::kCameraFromWorld * test::standing_at(0, 0, 0, 0.4) * tilt;
  const Observed empty = observe({test::table(test::kCameraFromWorld)});
  EXPECT_LT(occlusion(empty, *brick_, sunk), -0.8);
}

TEST_F(BoundaryScores, WalksFromTheTruthStayOnTheModel) {
  const Observed scene = observe(l_on_table());
  const double best = walk(scene, test::kTruth);
  EXPECT_GT(best, -0.06);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    sum += walk(scene, test::disturbed(test::kTruth, 0.02, 0.3, seed)) / 20;
  }
  EXPECT_LT(sum, best - 0.04);
}

TEST_F(BoundaryScores, WalksAreStoppedByEdgesAlone) {
  Observed scene = observe(l_on_table());
  const double at_start = walk(scene, test::kTruth, {.steps = 0});
  EXPECT_GT(at_start, -0.02) << "starts are within a centimetre";
  std::fill(scene.edges.pixels.begin(), scene.edges.pixels.end(), 1.0f);
  EXPECT_EQ(walk(scene, test::kTruth, {.steps = 500}), at_start);
  std::fill(scene.edges.pixels.begin(), scene.edges.pixels.end(), 0.0f);
  EXPECT_LT(walk(scene, test::kTruth, {.steps = 2000}), -0.25) << "walks leave";
}

TEST_F(BoundaryScores, WalksDependOnTheSeedAlone) {
  const Observed scene = observe(l_on_table());
  const Pose pose = test::disturbed(test::kTruth, 0.02, 0.3, 1);
  EXPECT_EQ(walk(scene, pose, {.seed = 4}), walk(scene, pose, {.seed = 4}));
  EXPECT_NE(walk(scene, pose, {.seed = 4}), walk(scene, pose, {.seed = 5}));
  EXPECT_NEAR(walk(scene, pose, {.walks = 2000, .seed = 4}),
              walk(scene, pose, {.walks = 2000, .seed = 5}), 0.02);
  EXPECT_EQ(walk(scene, {test::kTruth.rotation, {0, 0, -1}}), -1);
}

}  // namespace
}  // namespace bpa::score
