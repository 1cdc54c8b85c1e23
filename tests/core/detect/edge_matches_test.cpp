// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/detect/matches.hpp"
#include "core/detect/refinement.hpp"
#include "core/model/model_index.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::detect {
namespace {

using test::Solid;

// A brick in front of a wall, its largest face straight to the camera: the surface says how far
// away it is, and only the edges say where across the view.
const Pose kTruth{Eigen::Quaterniond::Identity(), {0.02, -0.01, 0.7}};
const Solid kWall{Solid::Kind::box, {1, 1, 0.1}, {Eigen::Quaterniond::Identity(), {0, 0, 1.3}}};

class EdgeMatches : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { brick_ = test::brick_model(); }
  static void TearDownTestSuite() { brick_.reset(); }

  static SceneFeatures features_of(const std::vector<Solid>& solids) {
    SurfaceMapOptions options;
    return scene_features(surface_map(test::render(solids, test::kinect_camera()).frame, options),
                          {}, {});
  }
  static Pose beside(double x, double y) {
    Pose pose = kTruth;
    pose.translation += Eigen::Vector3d(x, y, 0);
    return pose;
  }

  static inline std::shared_ptr<const ObjectModel> brick_;
};

TEST_F(EdgeMatches, AreAsFarOffAsThePose) {
  const SceneFeatures scene = features_of({kWall, test::brick_solid(kTruth)});
  const Eigen::Vector3d shift(0.006, -0.004, 0);
  const FastPose pose = to_fast(beside(shift.x(), shift.y()));
  const ModelView& view = nearest_view(brick_->index->views, pose);
  int found = 0;
  double squares = 0;
  for (std::size_t k = 0; k < view.edges.size(); ++k) {
    const EdgePoint edge = edge_point(view_edge(*brick_, view, k), pose);
    const auto offset = match_edge(scene.image, edge, 0.02f);
    if (!offset) continue;
    // The brick's sides are straight: across them the edge is where it was before the shift.
    const double error = static_cast<double>(*offset) + edge.outward.cast<double>().dot(shift);
    squares += error * error;
    ++found;
  }
  EXPECT_GT(found, static_cast<int>(view.edges.size()) * 7 / 10);
  EXPECT_LT(std::sqrt(squares / found), 0.004) << "a pixel is 2.7 mm wide, the view one of 66";
}

TEST_F(EdgeMatches, AloneSayWhereAFaceIsAcrossTheView) {
  const SceneFeatures scene = features_of({kWall, test::brick_solid(kTruth)});
  for (const double x : {-0.008, 0.008}) {
    RefinementOptions options;
    options.iterations = 10;
    const auto error = [&] {
      return pose_error(refine_pose(scene, *brick_, beside(x, -x), options).frame_from_object,
                        kTruth)
          .position;
    };
    EXPECT_LT(error(), 0.003);
    options.max_edges = 0;
    EXPECT_GT(error(), 0.007);
  }
}

TEST_F(EdgeMatches, AreNotFoundWhereTheSurfaceGoesOn) {
  // The face flush with a wall.
  Solid wall = kWall;
  wall.camera_from_solid.translation.z() = kTruth.translation.z() - test::kBrickHalf.z() + 0.1;
  const SceneFeatures scene = features_of({wall});
  const FastPose pose = to_fast(kTruth);
  const ModelView& view = nearest_view(brick_->index->views, pose);
  for (std::size_t k = 0; k < view.edges.size(); ++k) {
    EXPECT_FALSE(match_edge(scene.image, edge_point(view_edge(*brick_, view, k), pose), 0.02f));
  }
}

TEST_F(EdgeMatches, AreNotFoundBehindWhatHidesThem) {
  // A board in front hides the left half of the brick: its border is not the brick's.
  const Solid board{Solid::Kind::box,
                    {0.1, 0.2, 0.005},
                    {Eigen::Quaterniond::Identity(), {0.02 - 0.1 * 0.5 / 0.7, -0.01, 0.5}}};
  const SceneFeatures scene = features_of({kWall, test::brick_solid(kTruth), board});
  const FastPose pose = to_fast(kTruth);
  const ModelView& view = nearest_view(brick_->index->views, pose);
  int left = 0, right = 0;
  for (std::size_t k = 0; k < view.edges.size(); ++k) {
    const EdgePoint edge = edge_point(view_edge(*brick_, view, k), pose);
    const bool found = match_edge(scene.image, edge, 0.01f).has_value();
    if (edge.point.x() < -0.01f) left += found;
    if (edge.point.x() > 0.05f) right += found;
  }
  EXPECT_EQ(left, 0);
  EXPECT_GT(right, 10);
}

}  // namespace
}  // namespace bpa::detect
