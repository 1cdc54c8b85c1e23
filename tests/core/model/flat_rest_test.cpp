// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/flat_rest.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/pose.hpp"

namespace bpa {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// Points 2 mm apart on the faces of a box about the origin.
Points box_points(const Eigen::Vector3f& half) {
  Points out;
  const auto count = [](float reach) { return static_cast<int>(std::lround(reach / 0.001f)); };
  for (int face = 0; face < 3; ++face) {
    const int a = (face + 1) % 3, b = (face + 2) % 3;
    for (int i = 0; i <= count(half[a]); ++i) {
      for (int j = 0; j <= count(half[b]); ++j) {
        Eigen::Vector3f p;
        p[a] = -half[a] + 0.002f * static_cast<float>(i);
        p[b] = -half[b] + 0.002f * static_cast<float>(j);
        for (const float side : {-1.0f, 1.0f}) {
          p[face] = side * half[face];
          out.push_back(p);
        }
      }
    }
  }
  return out;
}

// Points 2 mm apart on the side of a cylinder along x.
Points rod_points(float radius, float half_length) {
  Points out;
  for (float x = -half_length; x <= half_length; x += 0.002f) {
    for (int k = 0; k < 36; ++k) {
      const auto angle = static_cast<float>(k * M_PI / 18);
      out.push_back({x, radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  return out;
}

TEST(FlatRest, ASlabLiesOnItsTwoLargeFaces) {
  const auto rests = flat_rests(box_points({0.05f, 0.03f, 0.006f}));
  ASSERT_EQ(rests.size(), 2u);
  EXPECT_LT(rests[0].up.dot(rests[1].up), -0.99f);
  for (const FlatRest& rest : rests) {
    EXPECT_GT(std::abs(rest.up.z()), 0.999f);
    EXPECT_GT(std::abs(rest.axis.x()), 0.999f);
    EXPECT_NEAR(rest.length, 0.100, 0.004);
    EXPECT_NEAR(rest.width, 0.060, 0.004);
    EXPECT_LT((rest.centre + 0.006f * rest.up).norm(), 0.001f) << "below the middle, on the plane";
  }
}

TEST(FlatRest, ACardDoesNotStandOnItsEdge) {
  for (const FlatRest& rest : flat_rests(box_points({0.060f, 0.024f, 0.002f}))) {
    EXPECT_GT(std::abs(rest.up.z()), 0.999f);
  }
}

TEST(FlatRest, TheyMoveWithTheObjectsFrame) {
  const Pose motion{rotation_from_vector({0.3, -0.8, 0.5}), {0.2, -0.1, 0.4}};
  const Points before = box_points({0.05f, 0.03f, 0.006f});
  Points after;
  for (const Eigen::Vector3f& p : before)
    after.push_back((motion * p.cast<double>()).cast<float>());
  const auto first = flat_rests(before), moved = flat_rests(after);
  ASSERT_EQ(moved.size(), first.size());
  for (const FlatRest& rest : first) {
    const Eigen::Vector3f up = (motion.rotation * rest.up.cast<double>()).cast<float>();
    const auto same = std::ranges::find_if(
        moved, [&](const FlatRest& other) { return other.up.dot(up) > 0.999f; });
    ASSERT_NE(same, moved.end());
    EXPECT_LT((same->centre.cast<double>() - motion * rest.centre.cast<double>()).norm(), 0.003);
    EXPECT_NEAR(same->length, rest.length, 0.003);
  }
}

TEST(FlatRest, ARodLiesOnItsSideWhereverItIsTurned) {
  const auto rests = flat_rests(rod_points(0.008f, 0.07f));
  ASSERT_GE(rests.size(), 3u);
  for (const FlatRest& rest : rests) {
    EXPECT_LT(std::abs(rest.up.x()), 0.02f) << "not on its end";
    EXPECT_GT(std::abs(rest.axis.x()), 0.999f);
    EXPECT_NEAR(rest.length, 0.14, 0.005);
    EXPECT_NEAR(rest.centre.norm(), 0.008, 0.001);
  }
}

TEST(FlatRest, ThickObjectsHaveNone) {
  EXPECT_TRUE(flat_rests(box_points({0.02f, 0.02f, 0.02f})).empty()) << "a cube";
  EXPECT_TRUE(flat_rests(box_points({0.10f, 0.08f, 0.04f})).empty()) << "flat, but 8 cm high";
  EXPECT_TRUE(flat_rests({}).empty());
}

TEST(FlatRest, TheExtentIsThatOfARectangle) {
  Points rectangle;
  const Eigen::Vector3f along = Eigen::Vector3f(1, 2, 0).normalized();
  const Eigen::Vector3f across(-along.y(), along.x(), 0), middle(0.3f, -0.2f, 1);
  for (int i = -40; i <= 40; ++i) {
    for (int j = -10; j <= 10; ++j) {
      rectangle.push_back(
          middle + 0.001f * (static_cast<float>(i) * along + static_cast<float>(j) * across));
    }
  }
  const FlatExtent extent = flat_extent(rectangle, Eigen::Vector3f::UnitZ());
  EXPECT_LT((extent.middle - middle).norm(), 1e-4f);
  EXPECT_GT(std::abs(extent.axis.dot(along)), 0.9999f);
  EXPECT_NEAR(extent.length, 0.080, 0.002);
  EXPECT_NEAR(extent.width, 0.020, 0.002);
}

}  // namespace
}  // namespace bpa
