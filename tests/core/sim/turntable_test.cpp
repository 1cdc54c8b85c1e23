// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/turntable.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace bpa::sim {
namespace {

TurntableOptions small_turntable() {
  TurntableOptions options;
  options.step_deg = 60;
  options.camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
  options.sensor.kinect.registered = false;
  return options;
}

TEST(Turntable, RestingPosesDifferAndTouchThePlate) {
  const SimulatedObject mug = household_objects(std::vector<std::string>{"mug"}).front();
  const std::vector<Pose> poses = resting_poses(mug, 3, 1);
  ASSERT_GE(poses.size(), 2u);
  for (const Pose& pose : poses) {
    double lowest = 1;
    for (const Eigen::Vector3f& v : mug.mesh.vertices) {
      lowest = std::min(lowest, (pose * v.cast<double>()).z());
    }
    EXPECT_NEAR(lowest, 0, 1e-6);
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double cosine =
      (poses[0].rotation.conjugate() * up).dot(poses[1].rotation.conjugate() * up);
  EXPECT_LT(cosine, std::cos(0.5));
}

TEST(Turntable, ViewsTurnAboutOneAxis) {
  const SimulatedObject brick = household_objects(std::vector<std::string>{"l_brick"}).front();
  const TurntableScan scan = simulate_turntable(brick, small_turntable(), 5, 2);
  ASSERT_EQ(scan.views.size(), 12u);
  for (std::size_t i = 1; i < scan.views.size(); ++i) {
    const TurntableView& a = scan.views[i - 1];
    const TurntableView& b = scan.views[i];
    ASSERT_EQ(b.frame.instances.size(), 1u);
    EXPECT_GT(b.frame.instances[0].visibility.fraction(), 0.999);
    if (a.resting_position != b.resting_position) continue;
    const Pose motion =
        b.frame.instances[0].camera_from_object * a.frame.instances[0].camera_from_object.inverse();
    const Eigen::Vector3d turn = vector_from_rotation(motion.rotation);
    EXPECT_LT((turn - std::numbers::pi / 3 * scan.axis_in_camera.axis).norm(), 1e-6);
    EXPECT_LT((motion * scan.axis_in_camera.point - scan.axis_in_camera.point).norm(), 1e-9);
  }
}

TEST(Turntable, ViewsAreShared) {
  const SimulatedObject brick = household_objects(std::vector<std::string>{"l_brick"}).front();
  TurntableOptions options = small_turntable();
  options.step_deg = 90;
  options.max_views = 6;
  options.resting_positions = 2;
  const TurntableScan one = simulate_turntable(brick, options, 5, 1);
  const TurntableScan two = simulate_turntable(brick, options, 5, 2);
  ASSERT_EQ(one.views.size(), 6u);
  EXPECT_EQ(one.views[4].frame.frame.depth, two.views[4].frame.frame.depth);
}

}  // namespace
}  // namespace bpa::sim
