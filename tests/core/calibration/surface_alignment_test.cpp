// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/surface_alignment.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/symmetry.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::calibration {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Three boxes, a ball and a table, seen from three sides.
class SurfaceAlignmentOf : public ::testing::Test {
 protected:
  SurfaceAlignmentOf() {
    for (const Eigen::Vector3d& eye :
         {Eigen::Vector3d(0.1, -0.7, 0.5), {0.6, -0.2, 0.5}, {0.5, 0.5, 0.6}}) {
      const Pose camera_from_world = test::look_at(eye, {0, 0, 0});
      const auto box = [&](const Eigen::Vector3d& half, double x, double y, double angle) {
        return test::Solid{test::Solid::Kind::box, half,
                           camera_from_world * test::standing_at(x, y, half.z(), angle)};
      };
      const std::vector<test::Solid> solids = {
          test::table(camera_from_world),
          box({0.06, 0.04, 0.08}, 0, 0, 0.4),
          box({0.05, 0.08, 0.04}, 0.2, 0.1, 1),
          box({0.1, 0.03, 0.05}, -0.15, 0.12, -0.7),
          {test::Solid::Kind::sphere,
           {0.05, 0, 0},
           camera_from_world * test::standing_at(-0.1, -0.15, 0.05, 0)}};
      maps_.push_back(
          surface_map(test::render(solids, test::kinect_camera(), 1, maps_.size()).frame, {}));
      truth_.push_back(camera_from_world.inverse());
    }
  }

  std::vector<PosedSurface> at(const std::vector<Pose>& poses) const {
    std::vector<PosedSurface> out;
    for (std::size_t v = 0; v < poses.size(); ++v) out.push_back({&maps_[v], poses[v]});
    return out;
  }

  std::vector<SurfaceMap> maps_;
  std::vector<Pose> truth_;
};

// A camera moved by so much, and turned by `degrees` about its own centre.
Pose moved(const Pose& pose, const Eigen::Vector3d& by, double degrees,
           const Eigen::Vector3d& axis) {
  return {rotation_from_vector(degrees * kDegree * axis.normalized()) * pose.rotation,
          pose.translation + by};
}

TEST_F(SurfaceAlignmentOf, LeavesExactCamerasWhereTheyAre) {
  const SurfaceAlignment found = align_surfaces(at(truth_));
  ASSERT_EQ(found.pairs.size(), 3u);
  for (const SurfaceDisagreement& pair : found.pairs) {
    EXPECT_LT(pair.position_m, 0.0015);
    EXPECT_LT(pair.angle_rad, 0.15 * kDegree);
    EXPECT_LT(pair.residual_m, 0.002);
  }
}

TEST_F(SurfaceAlignmentOf, SaysHowFarAWrongCameraIsOff) {
  std::vector<Pose> wrong = truth_;
  wrong[1] = moved(wrong[1], {0.006, -0.004, 0.003}, 0, {1, 0, 0});
  const double by = Eigen::Vector3d(0.006, -0.004, 0.003).norm();
  const SurfaceAlignment found = align_surfaces(at(wrong));
  for (const SurfaceDisagreement& pair : found.pairs) {
    const bool of_it = pair.first == 1 || pair.second == 1;
    EXPECT_NEAR(pair.position_m, of_it ? by : 0, 0.002) << pair.first << " " << pair.second;
    EXPECT_LT(pair.aligned_m, 0.002);
    if (of_it) {
      EXPECT_GT(pair.residual_m, pair.aligned_m);
    }
  }
}

TEST_F(SurfaceAlignmentOf, FindsWhereCamerasAreToOneAnother) {
  std::vector<Pose> wrong = {moved(truth_[0], {0.005, 0, 0}, 0.5, {0, 1, 1}),
                             moved(truth_[1], {0, -0.005, 0}, 0.5, {1, 0, -1}),
                             moved(truth_[2], {0, 0.003, 0.004}, 0.5, {1, 1, 0})};
  const SurfaceAlignment found = align_surfaces(at(wrong));
  for (std::size_t v = 1; v < truth_.size(); ++v) {
    const PoseError error =
        pose_error(found.scene_from_camera[0].inverse() * found.scene_from_camera[v],
                   truth_[0].inverse() * truth_[v]);
    EXPECT_LT(error.position, 0.002);
    EXPECT_LT(error.angle, 0.15 * kDegree);
  }
}

TEST_F(SurfaceAlignmentOf, ViewsWithoutCommonSurfaceAreNotCompared) {
  std::vector<Pose> apart = {truth_[0], moved(truth_[1], {5, 0, 0}, 0, {1, 0, 0})};
  const SurfaceAlignment found = align_surfaces(at(apart));
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_EQ(found.scene_from_camera[1].translation, apart[1].translation);
}

TEST(DisagreementText, NamesBothCamerasAndSaysByHowMuch) {
  const SurfaceDisagreement pair{.first = 0,
                                 .second = 1,
                                 .matches = 1000,
                                 .residual_m = 0.0061,
                                 .aligned_m = 0.0008,
                                 .position_m = 0.0123,
                                 .angle_rad = 0.5 * kDegree};
  EXPECT_EQ(disagreement_text(pair, "left", "right"),
            "cameras \"left\" and \"right\" disagree by 12.3 mm and 0.50 degrees: moving one so "
            "reduces the median distance of their surfaces from 6.1 to 0.8 mm");
}

}  // namespace
}  // namespace bpa::calibration
