// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Depth carried over to the colour camera, against closed forms.
#include "camera/registration.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace bpa::camera {
namespace {

DeviceGeometry kinect() {
  DeviceGeometry g;
  g.depth = {320, 240, 285, 285, 159.5, 119.5};
  g.color = {320, 240, 262, 262, 159.5, 119.5};
  return g;
}

/// A wall at `far` with a square of `near` in front, as a camera at x = `offset` metres sees them.
/// The square reaches from -0.1 to 0.1 m.
std::vector<std::uint16_t> square_scene(const Camera& camera, double offset, int near_mm,
                                        int far_mm) {
  std::vector<std::uint16_t> depth;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d p = camera.unproject(u, v, near_mm / 1000.0);
      const bool square = std::abs(p.x() + offset) < 0.1 && std::abs(p.y()) < 0.1;
      depth.push_back(static_cast<std::uint16_t>(square ? near_mm : far_mm));
    }
  }
  return depth;
}

std::uint16_t at(const std::vector<std::uint16_t>& image, const Camera& camera, double u,
                 double v) {
  return image[static_cast<std::size_t>(std::lround(v)) * static_cast<std::size_t>(camera.width) +
               static_cast<std::size_t>(std::lround(u))];
}

TEST(RegisterDepth, CornersFallWhereTheColourCameraSeesThem) {
  const DeviceGeometry g = kinect();
  const auto out = register_depth(square_scene(g.depth, 0, 700, 1500), g);
  ASSERT_EQ(out.size(), 320U * 240U);
  for (const double sx : {-1, 1}) {
    for (const double sy : {-1, 1}) {
      // The corner in the colour camera, which stands 25 mm to the right.
      const Eigen::Vector2d corner = g.color.project({sx * 0.1 - g.baseline, sy * 0.1, 0.7});
      EXPECT_EQ(at(out, g.color, corner.x() - sx, corner.y() - sy), 700);  // one pixel inside
      // One pixel outside the square there is none of it: wall, or nothing where the depth camera
      // does not see the wall that the colour camera sees.
      EXPECT_NE(at(out, g.color, corner.x() + sx, corner.y() + sy), 700);
    }
  }
}

TEST(RegisterDepth, TheNearerSurfaceHidesTheFartherOne) {
  const DeviceGeometry g = kinect();
  const auto out = register_depth(square_scene(g.depth, 0, 700, 1500), g);
  const auto expected = square_scene(g.color, g.baseline, 700, 1500);
  int wrong = 0, holes = 0;
  for (int v = 12; v < 228; ++v) {  // what the depth camera sees, which has longer lenses
    for (int u = 15; u < 300; ++u) {
      const int z = at(out, g.color, u, v);
      if (z == 0) ++holes;
      if (z != 0 && z != at(expected, g.color, u, v)) ++wrong;
    }
  }
  // At most a row of pixels along the square's border of 4 x 75 pixels.
  EXPECT_LT(wrong, 160) << holes;
  // Holes: the band behind the square that only colour sees (5 x 75 pixels), and none on surfaces
  // but a column or row where the focal lengths' ratio leaves one.
  EXPECT_LT(holes, 900);
}

TEST(RegisterDepth, AnotherSizeOfColourAndAWall) {
  DeviceGeometry g = kinect();
  g.color = {640, 480, 525, 525, 319.5, 239.5};
  const auto out = register_depth(std::vector<std::uint16_t>(320 * 240, 1000), g);
  ASSERT_EQ(out.size(), 640U * 480U);
  int holes = 0;
  for (int v = 40; v < 440; ++v) {
    for (int u = 60; u < 580; ++u) {
      const std::uint16_t z = at(out, g.color, u, v);
      EXPECT_TRUE(z == 1000 || z == 0);
      if (z == 0) ++holes;
    }
  }
  EXPECT_EQ(holes, 0);
}

TEST(RegisterDepth, ALensBendsTheImageAsItBendsTheColours) {
  DeviceGeometry g = kinect();
  g.color_distortion = {0.2, -0.1, 0, 0, 0};
  const auto depth = square_scene(g.depth, 0, 700, 1500);
  const auto out = register_depth(depth, g);
  const double x = (0.1 - g.baseline) / 0.7, y = 0.1 / 0.7, r2 = x * x + y * y;
  const double bend = 1 + r2 * (0.2 - 0.1 * r2);
  const double u = g.color.fx * x * bend + g.color.cx, v = g.color.fy * y * bend + g.color.cy;
  EXPECT_EQ(at(out, g.color, u - 1, v - 1), 700);
  EXPECT_NE(at(out, g.color, u + 1, v + 1), 700);
}

TEST(RegisterDepth, NothingComesFromNothing) {
  const DeviceGeometry g = kinect();
  for (const std::uint16_t z : register_depth(std::vector<std::uint16_t>(320 * 240, 0), g)) {
    ASSERT_EQ(z, 0);
  }
}

TEST(JudgeRegistration, TellsTheTruthFromALie) {
  const DeviceGeometry g = kinect();
  const auto before = square_scene(g.depth, 0, 700, 1500);
  const auto really = square_scene(g.color, g.baseline, 700, 1500);
  EXPECT_EQ(judge_registration(before, really, g), Alignment::registered);
  EXPECT_EQ(judge_registration(before, before, g), Alignment::not_registered);
  // Another view meanwhile shows neither.
  std::vector<std::uint16_t> other(before.size(), 2600);
  EXPECT_EQ(judge_registration(before, other, g), Alignment::cannot_tell);
  const std::vector<std::uint16_t> wall(before.size(), 1000);
  EXPECT_EQ(judge_registration(wall, wall, g), Alignment::cannot_tell);
  EXPECT_EQ(judge_registration(before, {}, g), Alignment::cannot_tell);
}

}  // namespace
}  // namespace bpa::camera
