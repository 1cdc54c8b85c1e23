// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/background.hpp"

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa::track {
namespace {

constexpr SensorKind kSensor = SensorKind::structured_light;

Frame seen_from(const Eigen::Vector3d& place) {
  const Pose camera_from_world = test::look_at(place, {0, 0, 0});
  const std::vector<test::Solid> solids = {test::table(camera_from_world)};
  return test::render(solids, test::kinect_camera(320), 1, 1).frame;
}
Pose world_from_camera(const Eigen::Vector3d& place) {
  return test::look_at(place, {0, 0, 0}).inverse();
}

const Eigen::Vector3d kHere{0.1, -0.7, 0.6}, kThere{0.1, -0.9, 0.9};

TEST(Background, IsTheTableInTheFixedFrame) {
  Background background;
  background.find(seen_from(kHere), kSensor, world_from_camera(kHere));
  ASSERT_EQ(background.planes().size(), 1u);
  const Plane& table = background.planes()[0];
  EXPECT_NEAR(table.normal.z(), 1, 1e-3);
  EXPECT_NEAR(table.height({0, 0, 0}), 0, 0.003);
}

TEST(Background, StaysWhereTheCameraIsKnownToBe) {
  Background background;
  background.find(seen_from(kHere), kSensor, world_from_camera(kHere));
  background.check(seen_from(kThere), world_from_camera(kThere));
  EXPECT_EQ(background.planes().size(), 1u);
}

TEST(Background, IsForgottenWhereTheCameraHasMovedUnsaid) {
  Background background;
  background.find(seen_from(kHere), kSensor, Pose());
  background.check(seen_from(kHere), Pose());
  EXPECT_EQ(background.planes().size(), 1u);
  background.check(seen_from(kThere), Pose());
  EXPECT_TRUE(background.planes().empty());
}

}  // namespace
}  // namespace bpa::track
