// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/observation/flat_regions.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/solid_scene.hpp"

namespace bpa {
namespace {

const Eigen::Vector3f kWhite(90, 0, 0), kRed(50, 60, 40);  // CIELAB

// A table that the camera looks at from above at a slant, and what is painted on it.
class FlatRegionsTest : public ::testing::Test {
 protected:
  void see(const std::vector<test::Solid>& more = {}, float noise = 1) {
    std::vector<test::Solid> solids{test::table(test::kCameraFromWorld)};
    solids.insert(solids.end(), more.begin(), more.end());
    map_ = surface_map(test::render(solids, test::kinect_camera(), noise, 8).frame, {});
    planes_ = label_background_planes(map_, {});
    ASSERT_EQ(planes_.size(), 1u);
  }
  // `color` gives that of a point of the table, in world coordinates.
  Image<Eigen::Vector3f> painted(const auto& color) const {
    const Pose world_from_camera = test::kCameraFromWorld.inverse();
    Image<Eigen::Vector3f> out(map_.width(), map_.height(), kWhite);
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (map_.depth[i] > 0) out[i] = color(world_from_camera * map_.points[i].cast<double>());
    }
    return out;
  }
  // A red rectangle of 12 cm x 5 cm.
  Image<Eigen::Vector3f> with_rectangle() const {
    return painted([&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d at = world_from_rectangle_.inverse() * p;
      return std::abs(at.x()) < 0.06 && std::abs(at.y()) < 0.025 ? kRed : kWhite;
    });
  }

  SurfaceMap map_;
  std::vector<Plane> planes_;
  const Pose world_from_rectangle_ = test::standing_at(0.05, 0.02, 0, 0.5);
};

TEST_F(FlatRegionsTest, WhatIsPaintedOnATableIsARegion) {
  see();
  const FlatRegions found = find_flat_regions(map_, planes_, with_rectangle());
  ASSERT_EQ(found.regions.size(), 1u);
  const FlatRegion& region = found.regions[0];
  const Pose camera_from_rectangle = test::kCameraFromWorld * world_from_rectangle_;
  const auto direction = [&](int axis) -> Eigen::Vector3d {
    return camera_from_rectangle.rotation * Eigen::Vector3d::Unit(axis);
  };
  EXPECT_LT((region.centre.cast<double>() - camera_from_rectangle.translation).norm(), 0.004);
  EXPECT_GT(region.up.cast<double>().dot(direction(2)), 0.999);
  EXPECT_GT(std::abs(region.axis.cast<double>().dot(direction(0))), 0.998);
  EXPECT_NEAR(region.length, 0.12, 0.006);
  EXPECT_NEAR(region.width, 0.05, 0.006);
  EXPECT_EQ(std::ranges::count(found.label.pixels, 0), region.pixels);
}

TEST_F(FlatRegionsTest, WithoutColoursAnEvenTableHasNone) {
  see();
  EXPECT_TRUE(find_flat_regions(map_, planes_, {}).regions.empty());
  EXPECT_TRUE(find_flat_regions(map_, {}, with_rectangle()).regions.empty()) << "no plane";
}

TEST_F(FlatRegionsTest, TheSquaresOfAClothAreNone) {
  see();
  const auto cloth = painted([](const Eigen::Vector3d& p) {
    const double squares = std::floor(p.x() / 0.06) + std::floor(p.y() / 0.06);
    return std::fmod(std::abs(squares), 2) < 0.5 ? kRed : kWhite;
  });
  EXPECT_TRUE(find_flat_regions(map_, planes_, cloth).regions.empty());
}

TEST_F(FlatRegionsTest, ALowSlabIsOneWithoutColoursAndAHighBoxIsNot) {
  const auto box = [](double half_height) {
    const Pose pose = test::kCameraFromWorld * test::standing_at(-0.05, 0, half_height, 0.3);
    return test::Solid{test::Solid::Kind::box, {0.06, 0.03, half_height}, pose};
  };
  see({box(0.010)});
  const auto low = find_flat_regions(map_, planes_, {}).regions;
  ASSERT_GE(low.size(), 1u);
  const Eigen::Vector3d middle = test::kCameraFromWorld * Eigen::Vector3d(-0.05, 0, 0);
  EXPECT_LT((low[0].centre.cast<double>() - middle).norm(), 0.010);
  see({box(0.050)});
  EXPECT_TRUE(find_flat_regions(map_, planes_, {}).regions.empty()) << "the foot of the box";
}

}  // namespace
}  // namespace bpa
