// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/edges.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::features {
namespace {

using test::Solid;

const Pose kCameraFromWorld = test::look_at({0.0, -0.6, 0.45}, {0, 0, 0.05});

// A block on the table, as wide as the table; its foot, the line y = 0 of the table's top, is the
// one hollow, its near top edge the one bulge.
SurfaceMap block_on_table(float noise) {
  const Solid block{
      Solid::Kind::box, {0.7, 0.1, 0.15}, kCameraFromWorld * test::standing_at(0, 0.1, 0.0, 0)};
  const auto image =
      test::render({test::table(kCameraFromWorld), block}, test::kinect_camera(), noise, 6);
  return surface_map(image.frame, {});
}

// The rows where the foot and the top edge of the block are in column u.
double row_of(const SurfaceMap& map, const Eigen::Vector3d& world, int u) {
  const Eigen::Vector3d along = kCameraFromWorld.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d p = kCameraFromWorld * world;
  const double slope = (u - map.camera.cx) / map.camera.fx;  // solves (p + t along).x = slope z
  const double t = (slope * p.z() - p.x()) / (along.x() - slope * along.z());
  return map.camera.project(p + t * along).y();
}

TEST(CurvatureEdges, AreTheFootOfABlockAndNotItsTop) {
  for (const float noise : {0.0f, 1.0f}) {
    const SurfaceMap map = block_on_table(noise);
    const Image<std::uint8_t> edges = curvature_edges(map);
    int columns = 0, elsewhere = 0, found = 0;
    for (int u = 60; u < 260; ++u) {
      const double foot = row_of(map, {0, 0, 0}, u), top = row_of(map, {0, 0, 0.15}, u);
      ASSERT_LT(top + 30, foot);
      bool here = false;
      for (int v = 20; v < 220; ++v) {
        if (!edges.at(u, v)) continue;
        here |= std::abs(v - foot) < 2.5;
        elsewhere += std::abs(v - foot) > 4;
      }
      found += here;
      ++columns;
    }
    EXPECT_GT(found, columns * 97 / 100) << noise;
    EXPECT_LT(elsewhere, noise > 0 ? 20 : 1) << noise;
  }
}

TEST(HollowMap, OnABallIsOneOverItsRadius) {
  const double radius = 0.08;
  const auto image = test::render(
      {{Solid::Kind::sphere, {radius, 0, 0}, {Eigen::Quaterniond::Identity(), {0, 0, 0.7}}}},
      test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  const HollowMap hollow = hollow_map(map);
  std::vector<float> seen;
  for (int v = -15; v <= 15; ++v) {
    for (int u = -15; u <= 15; ++u) seen.push_back(hollow.curvature.at(160 + u, 120 + v));
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_NEAR(seen[seen.size() / 2], 1 / radius, 1);
  EXPECT_GT(seen.front(), 0.7 / radius);
}

TEST(HollowMap, OnAPlaneIsZeroAndAcrossAStepUnknown) {
  const Solid wall{Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {0, 0, 1.55}}};
  const Solid near{Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {5, 0, 1.05}}};
  const SurfaceMap map = surface_map(test::render({wall, near}, test::kinect_camera()).frame, {});
  const HollowMap hollow = hollow_map(map);
  for (const float curvature : hollow.curvature.pixels) ASSERT_NEAR(curvature, 0, 0.5);
  const Image<std::uint8_t> edges = curvature_edges(map);
  EXPECT_EQ(std::count(edges.pixels.begin(), edges.pixels.end(), 1), 0);
}

TEST(CurvatureEdges, TheSameForAnyNumberOfThreads) {
  const SurfaceMap map = block_on_table(2);
  EXPECT_EQ(curvature_edges(map, {.num_threads = 1}).pixels,
            curvature_edges(map, {.num_threads = 3}).pixels);
  EXPECT_TRUE(curvature_edges(SurfaceMap()).empty());
}

}  // namespace
}  // namespace bpa::features
