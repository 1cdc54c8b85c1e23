// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/tolerance.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

using test::Solid;

// A wall 1 m away whose right half is `step` metres nearer; its edge is between columns 159 and
// 160 of the map.
SurfaceMap stepped_wall(double step) {
  const Solid wall{Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {0, 0, 1.05}}};
  const Solid right{
      Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {5, 0, 1.05 - step}}};
  return surface_map(test::render({wall, right}, test::kinect_camera()).frame, {});
}

int breaks_between_columns(const SurfaceMap& map, int column) {
  int breaks = 0;
  for (int v = 0; v < map.height(); ++v) {
    const auto i = static_cast<std::size_t>(v * map.width() + column);
    breaks += surface_breaks(map, i, i + 1);
  }
  return breaks;
}

TEST(SurfaceBreak, AStepHigherThanNoiseIsOne) {
  EXPECT_EQ(breaks_between_columns(stepped_wall(0.03), 159), 240);
  EXPECT_EQ(breaks_between_columns(stepped_wall(0.03), 158), 0);
  EXPECT_EQ(breaks_between_columns(stepped_wall(0.5), 159), 240);
  EXPECT_EQ(breaks_between_columns(stepped_wall(0.004), 159), 0);
}

TEST(SurfaceBreak, ANoisierSensorNeedsAHigherStep) {
  SurfaceMap map = stepped_wall(0.03);
  map.noise.floor = 0.02f;
  EXPECT_EQ(breaks_between_columns(map, 159), 0);
}

TEST(Tolerance, IsOfSensorAndModelTogether) {
  for (const tolerance::Sigmas& sigmas :
       {tolerance::kOnSurface, tolerance::kBreaks, tolerance::kGoesOn, tolerance::kApart}) {
    EXPECT_NEAR(sigmas(0.006f), sigmas.count * std::hypot(0.006, 0.0025), 1e-6);
    EXPECT_NEAR(sigmas(0), sigmas.count * 0.0025, 1e-6);
  }
}

TEST(SurfaceBreak, ASlopeIsNone) {
  // Where it is seen at less than 75 degrees; neighbouring pixels are up to 15 mm apart in depth.
  for (const double angle : {0.0, 0.8, -1.2, 1.25}) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
    const Solid wall{Solid::Kind::box,
                     {5, 5, 0.05},
                     {turn, Eigen::Vector3d(0, 0, 1) + turn * Eigen::Vector3d(0, 0, 0.05)}};
    const SurfaceMap map = surface_map(test::render({wall}, test::kinect_camera()).frame, {});
    const auto width = static_cast<std::size_t>(map.width());
    int compared = 0;
    for (std::size_t i = 0; i + width < map.size(); ++i) {
      if (map.depth[i] <= 0 || map.depth[i + width] <= 0) continue;
      const Eigen::Vector3d ray = map.points[i].cast<double>().normalized();
      if (ray.dot(turn * Eigen::Vector3d::UnitZ()) < std::cos(75 * M_PI / 180)) continue;
      ++compared;
      ASSERT_FALSE(surface_breaks(map, i, i + width)) << angle << " at " << map.depth[i];
    }
    EXPECT_GT(compared, 5000);
  }
}

TEST(SurfaceBreak, BothWaysAlike) {
  const SurfaceMap map = stepped_wall(0.02);
  for (std::size_t i = 0; i + 1 < map.size(); i += 7) {
    EXPECT_EQ(surface_breaks(map, i, i + 1), surface_breaks(map, i + 1, i));
  }
}

}  // namespace
}  // namespace bpa
