// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/observe.hpp"

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa::track {
namespace {

using Around = test::LScene;

// Normals are fitted in windows of up to 8 pixels: beside the border they see less.
constexpr int kBorder = 9;

TEST_F(Around, IsTheSamePartOfTheWholeMap) {
  const Frame frame = test::render(everything(), test::kinect_camera(), 1).frame;
  const SurfaceMap whole = surface_map(frame, {});
  const auto around = surroundings(frame, *l_, l_truth_, 0.03);
  ASSERT_TRUE(around);
  const SceneFeatures part = observe_part(frame, *around, SensorKind::structured_light, {});
  const int u0 = around->x / whole.reduction, v0 = around->y / whole.reduction;
  ASSERT_EQ(part.map.width() * whole.reduction, around->width);
  int compared = 0;
  for (int v = kBorder; v + kBorder < part.map.height(); ++v) {
    for (int u = kBorder; u + kBorder < part.map.width(); ++u) {
      const std::size_t i = v * part.map.width() + u;
      const std::size_t k = (v0 + v) * whole.width() + u0 + u;
      ASSERT_EQ(part.map.depth[i], whole.depth[k]);
      ASSERT_LT((part.map.points[i] - whole.points[k]).norm(), 1e-6f);
      ASSERT_LT((part.map.normals[i] - whole.normals[k]).norm(), 1e-3f);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(Around, HoldsTheWholeObjectAndLittleElse) {
  const auto image = test::render(everything(), test::kinect_camera());
  const auto around = surroundings(image.frame, *brick_, brick_truth_, 0.02);
  ASSERT_TRUE(around);
  constexpr int kBrick = 3;  // of the solids: table, two of the L
  const RegionOfInterest& r = *around;
  for (std::size_t i = 0; i < image.solid.size(); ++i) {
    if (image.solid[i] != kBrick) continue;
    const auto u = static_cast<int>(i) % 640, v = static_cast<int>(i) / 640;
    ASSERT_TRUE(u >= r.x && v >= r.y && u < r.x + r.width && v < r.y + r.height);
  }
  EXPECT_LT(r.width * r.height, 640 * 480 / 4);
}

TEST_F(Around, NothingOutOfView) {
  const Frame frame = test::render(table_only(), test::kinect_camera()).frame;
  const auto at = [&](double x, double z) {
    return surroundings(frame, *l_, {Eigen::Quaterniond::Identity(), {x, 0, z}}, 0.02);
  };
  EXPECT_TRUE(at(0, 1));
  EXPECT_FALSE(at(5, 1));
  EXPECT_FALSE(at(-5, 1));
  EXPECT_FALSE(at(0, -1));
  EXPECT_FALSE(at(0, 100));  // a few pixels
}

}  // namespace
}  // namespace bpa::track
