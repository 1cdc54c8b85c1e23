// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/surface_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

using test::Solid;

double degrees_between(const Eigen::Vector3f& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.cast<double>().dot(b), -1.0, 1.0)) * 180 / M_PI;
}

// A slab tilted by `angle` about the camera's y axis, `depth` away on the optical axis.
Solid tilted_wall(double depth, double angle) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d front = Eigen::Vector3d(0, 0, depth);
  return {Solid::Kind::box, {5, 5, 0.05}, {turn, front + turn * Eigen::Vector3d(0, 0, 0.05)}};
}

double percentile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

TEST(SurfaceMap, PlaneHasItsDepthsAndNormals) {
  const auto image = test::render({tilted_wall(1.0, 0.6)}, test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  const Eigen::Vector3d normal(-std::sin(0.6), 0, -std::cos(0.6));
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.depth[i] <= 0) continue;
    const Eigen::Vector3d p = map.points[i].cast<double>();
    ASSERT_NEAR(normal.dot(p), -std::cos(0.6), 2e-4);  // the plane's equation
    ASSERT_LT(degrees_between(map.normals[i], normal), 0.3);
  }
}

TEST(SurfaceMap, SphereHasItsNormals) {
  const Eigen::Vector3d centre(0.05, -0.03, 0.8);
  const auto image =
      test::render({{Solid::Kind::sphere, {0.1, 0, 0}, {Eigen::Quaterniond::Identity(), centre}}},
                   test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  std::vector<double> angles;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.depth[i] <= 0) continue;
    const Eigen::Vector3d p = map.points[i].cast<double>();
    const Eigen::Vector3d normal = (p - centre).normalized();
    if (normal.dot(p.normalized()) > -0.5) continue;  // the rim, where windows end
    angles.push_back(degrees_between(map.normals[i], normal));
  }
  ASSERT_GT(angles.size(), 2000u);
  EXPECT_LT(percentile(angles, 0.5), 1);
  EXPECT_LT(percentile(angles, 1.0), 4);
}

TEST(SurfaceMap, NoiseIsMostlyRemovedFromNormals) {
  const auto image = test::render({tilted_wall(1.0, 0.4)}, test::kinect_camera(), 1, 5);
  const SurfaceMap map = surface_map(image.frame, {});
  const Eigen::Vector3d normal(-std::sin(0.4), 0, -std::cos(0.4));
  std::vector<double> angles;
  for (const Eigen::Vector3f& n : map.normals) {
    if (n.squaredNorm() > 0) angles.push_back(degrees_between(n, normal));
  }
  ASSERT_GT(angles.size(), map.size() * 9 / 10);
  EXPECT_LT(percentile(angles, 0.5), 6);
  EXPECT_LT(percentile(angles, 0.95), 15);
}

// The plane of least squares through the points around a pixel, by Eigen in double precision.
// Windows end at the border of the map; those of more than four pixels' radius take every second
// pixel.
Eigen::Vector3d fitted_normal(const SurfaceMap& map, int u, int v) {
  const Eigen::Vector3f& centre = map.points[v * map.width() + u];
  const double pixels = SurfaceMapOptions().normal_radius_m * map.camera.fx / centre.z();
  const int radius = std::clamp(static_cast<int>(std::lround(pixels)), 2, 8);
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int y = v - radius; y <= v + radius; y += radius > 4 ? 2 : 1) {
    for (int x = u - radius; x <= u + radius; x += radius > 4 ? 2 : 1) {
      if (x < 0 || y < 0 || x >= map.width() || y >= map.height()) continue;
      points.push_back(map.points[y * map.width() + x].cast<double>());
      mean += points.back();
    }
  }
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    scatter += (point - mean) * (point - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return normal.z() > 0 ? Eigen::Vector3d(-normal) : normal;
}

TEST(SurfaceMap, NormalsAreThoseOfPlanesOfLeastSquares) {
  for (const double depth : {0.6, 1.4}) {
    const auto image = test::render({tilted_wall(depth, 0.4)}, test::kinect_camera(), 1, 5);
    const SurfaceMap map = surface_map(image.frame, {});
    ASSERT_EQ(std::ranges::count_if(map.depth, [](float z) { return z <= 0; }), 0);
    for (int v = 0; v < map.height(); v += 3) {
      for (int u = 0; u < map.width(); u += 5) {
        ASSERT_LT(degrees_between(map.normals[v * map.width() + u], fitted_normal(map, u, v)), 0.1)
            << u << " " << v;
      }
    }
  }
}

TEST(SurfaceMap, ReducesUntilItIsNarrowEnough) {
  const struct {
    int width, reduction;
  } cases[] = {{64, 1}, {400, 1}, {404, 2}, {640, 2}, {1280, 4}, {1920, 5}};
  for (const auto& [width, reduction] : cases) {
    const Camera camera = test::kinect_camera(width);
    Frame frame;
    frame.camera = camera;
    frame.depth.assign(static_cast<std::size_t>(camera.width * camera.height), 1.0f);
    const SurfaceMap map = surface_map(frame, {});
    EXPECT_EQ(map.reduction, reduction);
    EXPECT_EQ(map.width(), width / reduction);
    EXPECT_EQ(map.height(), camera.height / reduction);
    EXPECT_EQ(map.size(), static_cast<std::size_t>(map.width() * map.height()));
    // A map pixel looks where the middle of its block looks.
    const Eigen::Vector3d point = map.camera.unproject(7, 5, 1.3);
    const Eigen::Vector2d pixel = camera.project(point);
    EXPECT_NEAR(pixel.x(), 7 * reduction + 0.5 * (reduction - 1), 1e-9);
    EXPECT_NEAR(pixel.y(), 5 * reduction + 0.5 * (reduction - 1), 1e-9);
  }
}

TEST(SurfaceMap, PointsLieOnTheirPixelsAtTheirDepth) {
  const auto image = test::render({tilted_wall(0.7, -0.3)}, test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  for (std::size_t i = 0; i < map.size(); i += 37) {
    const Eigen::Vector2d pixel = map.camera.project(map.points[i].cast<double>());
    EXPECT_NEAR(pixel.x(), static_cast<double>(i % 320), 1e-3);
    EXPECT_NEAR(pixel.y(), static_cast<double>(i / 320), 1e-3);
    EXPECT_EQ(map.points[i].z(), map.depth[i]);
  }
}

TEST(SurfaceMap, KeepsDepthEdges) {
  // A disc-like sphere cut from view: everything is either near the box or near the wall.
  const Solid box{
      Solid::Kind::box, {0.101, 0.07, 0.05}, {Eigen::Quaterniond::Identity(), {0.013, 0.02, 0.75}}};
  const auto image = test::render({tilted_wall(0.9, 0), box}, test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  int front = 0, back = 0;
  for (const float z : map.depth) {
    front += std::abs(z - 0.7f) < 1e-4f;
    back += std::abs(z - 0.9f) < 1e-4f;
  }
  EXPECT_EQ(front + back, static_cast<int>(map.size())) << "no depth between the two";
  EXPECT_NEAR(front, 0.202 * 0.14 * 262.5 * 262.5 / 0.49, 150);
  for (std::size_t i = 0; i < map.size(); ++i) {
    ASSERT_LT(degrees_between(map.normals[i], -Eigen::Vector3d::UnitZ()), 0.5);
  }
}

TEST(SurfaceMap, HalfOfABlockMustHaveDepth) {
  Frame frame;
  frame.camera = test::kinect_camera();
  frame.depth.assign(640 * 480, 1.0f);
  frame.depth[0] = std::nanf("");                               // block 0: three left
  frame.depth[2] = frame.depth[3] = 0;                          // block 1: two left
  frame.depth[4] = frame.depth[5] = frame.depth[640 + 4] = -1;  // block 2: one left
  const SurfaceMap map = surface_map(frame, {});
  EXPECT_EQ(map.depth[0], 1.0f);
  EXPECT_EQ(map.depth[1], 1.0f);
  EXPECT_EQ(map.depth[2], 0.0f);
  EXPECT_EQ(map.searched[2], 0);
  EXPECT_EQ(map.normals[2], Eigen::Vector3f(Eigen::Vector3f::Zero()));
}

TEST(SurfaceMap, LonelyPixelsHaveNoNormal) {
  Frame frame;
  frame.camera = test::kinect_camera(320);
  frame.depth.assign(320 * 240, 0.0f);
  frame.depth[100 * 320 + 100] = 1.0f;
  const SurfaceMap map = surface_map(frame, {});
  EXPECT_EQ(map.depth[100 * 320 + 100], 1.0f);
  EXPECT_EQ(map.normals[100 * 320 + 100], Eigen::Vector3f(Eigen::Vector3f::Zero()));
}

TEST(SurfaceMap, SearchesWhereItMay) {
  auto image = test::render({tilted_wall(1.0, 0)}, test::kinect_camera());
  image.frame.roi = {100, 60, 200, 300};
  image.frame.mask.assign(640 * 480, 1);
  image.frame.background.assign(640 * 480, 0);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const auto i = static_cast<std::size_t>(v * 640 + u);
      if (v >= 300) image.frame.mask[i] = 0;
      if (u >= 240) image.frame.background[i] = 1;
    }
  }
  const SurfaceMap map = surface_map(image.frame, {});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto u = static_cast<int>(i % 320);
    const auto v = static_cast<int>(i / 320);
    ASSERT_EQ(map.searched[i] != 0, u >= 50 && u < 120 && v >= 30 && v < 150) << u << " " << v;
    ASSERT_GT(map.depth[i], 0) << "what is not searched is seen nevertheless";
  }
}

// The map has half the frame's resolution: blocks of 2 x 2 pixels that a mask cuts.
TEST(SurfaceMap, BlockIsSearchedWhenHalfOfItIs) {
  auto image = test::render({tilted_wall(1.0, 0)}, test::kinect_camera());
  for (int pattern = 0; pattern < 16; ++pattern) {  // one bit for each pixel of a block
    image.frame.mask.assign(640 * 480, 0);
    int count = 0;
    for (int k = 0; k < 4; ++k) {
      if ((pattern >> k & 1) == 0) continue;
      ++count;
      for (int v = k / 2; v < 480; v += 2) {
        for (int u = k % 2; u < 640; u += 2)
          image.frame.mask[static_cast<std::size_t>(v * 640 + u)] = 1;
      }
    }
    const SurfaceMap map = surface_map(image.frame, {});
    ASSERT_EQ(map.reduction, 2);
    const auto searched = std::count(map.searched.begin(), map.searched.end(), 1);
    EXPECT_EQ(searched, count >= 2 ? 320 * 240 : 0) << pattern;
  }
}

// Left of u = 321 the wall is near, and only that is searched: of the blocks across the border,
// which the near surface stands for, the pixels of the far one have no say.
TEST(SurfaceMap, PixelsOnAnotherSurfaceHaveNoSay) {
  auto image = test::render({tilted_wall(1.0, 0)}, test::kinect_camera());
  for (const bool near_is_searched : {true, false}) {
    image.frame.mask.assign(640 * 480, 0);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        const auto i = static_cast<std::size_t>(v * 640 + u);
        image.frame.depth[i] = u < 321 ? 1.0f : 1.5f;
        image.frame.mask[i] = (u < 321) == near_is_searched;
      }
    }
    const SurfaceMap map = surface_map(image.frame, {});
    for (std::size_t i = 0; i < map.size(); ++i) {
      ASSERT_EQ(map.searched[i] != 0, (map.depth[i] < 1.2f) == near_is_searched) << i % 320;
    }
    EXPECT_NEAR(map.depth[160], 1.0f, 1e-6f);  // the block across the border
  }
}

TEST(SurfaceMap, DoesNotSearchBeyondItsRange) {
  const auto image = test::render({tilted_wall(1.5, 0.7)}, test::kinect_camera());
  SurfaceMapOptions options;
  options.max_range_m = 1.4;
  const SurfaceMap map = surface_map(image.frame, options);
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_EQ(map.searched[i] != 0, map.depth[i] > 0 && map.depth[i] <= 1.4f);
  }
}

class SurfaceMapThreads : public ::testing::TestWithParam<int> {};

TEST_P(SurfaceMapThreads, GiveTheSameMap) {
  const Solid ball{Solid::Kind::sphere, {0.2, 0, 0}, {Eigen::Quaterniond::Identity(), {0, 0, 0.9}}};
  const auto image = test::render({tilted_wall(1.0, 0.5), ball}, test::kinect_camera(), 1, 2);
  SurfaceMapOptions options;
  options.num_threads = 1;
  const SurfaceMap one = surface_map(image.frame, options);
  options.num_threads = GetParam();
  const SurfaceMap many = surface_map(image.frame, options);
  EXPECT_EQ(one.depth, many.depth);
  EXPECT_EQ(one.points, many.points);
  EXPECT_EQ(one.normals, many.normals);
  EXPECT_EQ(one.searched, many.searched);
}

INSTANTIATE_TEST_SUITE_P(Threads, SurfaceMapThreads, ::testing::Values(2, 8));

}  // namespace
}  // namespace bpa
