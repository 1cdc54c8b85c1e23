// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include <bpa/core/base/random.hpp>
#include <bpa/core/features/point_pairs.hpp>
#include <bpa/core/geometry/pose.hpp>

namespace bpa {
namespace {

Eigen::Vector3f random_vector(RandomStream& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>();
}

PointCloud random_oriented_points(int count, std::uint64_t seed) {
  RandomStream random(seed);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points.push_back(0.05f * random_vector(random));
    cloud.normals.push_back(random_vector(random).normalized());
  }
  return cloud;
}

Pose random_pose(std::uint64_t seed) {
  RandomStream random(seed);
  return {Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
              .normalized(),
          {random.normal(), random.normal(), random.normal()}};
}

PointCloud moved(const PointCloud& cloud, const Pose& pose) {
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out.points.push_back((pose * cloud.points[i].cast<double>()).cast<float>());
    out.normals.push_back((pose.rotation * cloud.normals[i].cast<double>()).cast<float>());
  }
  return out;
}

PointPairFeature feature_of(const PointCloud& cloud, std::size_t i, std::size_t j) {
  return point_pair_feature(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j]);
}

TEST(PointPairs, FeatureOfAKnownPair) {
  const auto f = point_pair_feature({0, 0, 0}, Eigen::Vector3f::UnitZ(), {0.3f, 0, 0.3f},
                                    Eigen::Vector3f::UnitX());
  EXPECT_NEAR(f.distance, 0.3 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(f.angle_first, M_PI / 4, 1e-6);
  EXPECT_NEAR(f.angle_second, M_PI / 4, 1e-6);
  EXPECT_NEAR(f.angle_normals, M_PI / 2, 1e-6);
}

TEST(PointPairs, OppositeNormalsAlongTheLine) {
  const auto f = point_pair_feature({0, 0, 0}, -Eigen::Vector3f::UnitX(), {0.1f, 0, 0},
                                    Eigen::Vector3f::UnitX());
  EXPECT_NEAR(f.angle_first, M_PI, 1e-3);
  EXPECT_NEAR(f.angle_second, 0, 1e-3);
  EXPECT_NEAR(f.angle_normals, M_PI, 1e-3);
}

TEST(PointPairs, FeatureDoesNotChangeUnderRigidMotion) {
  const PointCloud cloud = random_oriented_points(40, 1);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PointCloud other = moved(cloud, random_pose(seed));
    for (std::size_t i = 0; i < 40; ++i) {
      const auto a = feature_of(cloud, i, (i + 7) % 40);
      const auto b = feature_of(other, i, (i + 7) % 40);
      EXPECT_NEAR(a.distance, b.distance, 2e-6);
      EXPECT_NEAR(a.angle_first, b.angle_first, 1e-3);
      EXPECT_NEAR(a.angle_second, b.angle_second, 1e-3);
      EXPECT_NEAR(a.angle_normals, b.angle_normals, 1e-3);
    }
  }
}

TEST(PointPairs, CoplanarPairsSayNothing) {
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  const auto informative = [&](const Eigen::Vector3f& q, const Eigen::Vector3f& nq) {
    return PointPairTable::informative(point_pair_feature({0, 0, 0}, up, q, nq));
  };
  EXPECT_FALSE(informative({0.05f, 0, 0}, up));
  EXPECT_FALSE(informative({0.05f, 0, 0.004f}, up));
  EXPECT_TRUE(informative({0.05f, 0, 0.05f}, up)) << "two steps of a stair";
  EXPECT_TRUE(informative({0.05f, 0, 0}, Eigen::Vector3f(0.6f, 0, 0.8f)));
  EXPECT_TRUE(informative({0.05f, 0, 0}, -up)) << "two sides";
}

constexpr float kDistanceStep = 0.006f;
constexpr float kAngleStep = 0.2618f;

using Cell = std::array<int, 4>;
using Pairs = std::set<std::pair<int, int>>;

Cell cell_of(const PointPairFeature& f) {
  const auto angle = [](float value) { return std::min(11, static_cast<int>(value / kAngleStep)); };
  return {static_cast<int>(f.distance / kDistanceStep), angle(f.angle_first), angle(f.angle_second),
          angle(f.angle_normals)};
}

Pairs looked_up(const PointPairTable& table, const PointPairFeature& feature) {
  Pairs out;
  for (const auto& [i, j] : table.lookup(feature)) {
    EXPECT_TRUE(out.insert({i, j}).second) << "a pair is there once";
  }
  return out;
}

TEST(PointPairTable, HoldsEveryInformativePairInItsCell) {
  const PointCloud cloud = random_oriented_points(90, 2);
  const PointPairTable table(cloud, kDistanceStep, kAngleStep);
  std::map<Cell, Pairs> expected;
  float longest = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      if (i == j) continue;
      const auto f = feature_of(cloud, i, j);
      if (f.distance < kDistanceStep || !PointPairTable::informative(f)) continue;
      expected[cell_of(f)].insert({static_cast<int>(i), static_cast<int>(j)});
      longest = std::max(longest, f.distance);
    }
  }
  EXPECT_EQ(table.max_distance(), longest);
  for (const auto& [cell, pairs] : expected) {
    const auto& [i, j] = *pairs.begin();
    const auto f = feature_of(cloud, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    EXPECT_EQ(looked_up(table, f), pairs);
  }
  // Cells that nothing is in.
  RandomStream random(3);
  for (int k = 0; k < 500; ++k) {
    const auto angle = [&] { return static_cast<float>(random.uniform(0, M_PI)); };
    const PointPairFeature f{static_cast<float>(random.uniform(0, 0.4)), angle(), angle(), angle()};
    const auto found = expected.find(cell_of(f));
    EXPECT_EQ(looked_up(table, f), found == expected.end() ? Pairs{} : found->second);
  }
}

TEST(PointPairTable, FindsThePairsOfAMovedCopy) {
  const PointCloud cloud = random_oriented_points(60, 4);
  const PointPairTable table(cloud, kDistanceStep, kAngleStep);
  const PointCloud other = moved(cloud, random_pose(5));
  int found = 0, all = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const auto f = feature_of(other, i, j);
      if (i == j || f.distance < kDistanceStep || !PointPairTable::informative(f)) continue;
      ++all;
      found +=
          static_cast<int>(looked_up(table, f).count({static_cast<int>(i), static_cast<int>(j)}));
    }
  }
  EXPECT_GT(found, all * 99 / 100) << "but for those on the border of two cells";
}

TEST(PointPairTable, HasNothingBeyondItsLongestPair) {
  const PointCloud cloud = random_oriented_points(30, 6);
  const PointPairTable table(cloud, kDistanceStep, kAngleStep);
  for (const float distance : {table.max_distance() + 0.01f, 1.0f, 1e9f, std::nanf("")}) {
    EXPECT_TRUE(table.lookup({distance, 1, 1, 1}).empty());
  }
  const auto pi = static_cast<float>(M_PI);
  (void)table.lookup({table.max_distance(), pi, pi, pi});  // the last cell of all
  (void)table.lookup({table.max_distance() + 0.9f * kDistanceStep, pi, pi, pi});
}

TEST(PointPairTable, OfNothingHoldsNothing) {
  const PointPairTable table({}, 1, 1);
  EXPECT_TRUE(table.lookup({0, 0, 0, 0}).empty());
  EXPECT_TRUE(table.lookup({0.5f, 1, 1, 1}).empty());
  const PointPairTable one(random_oriented_points(1, 7), kDistanceStep, kAngleStep);
  EXPECT_TRUE(one.lookup({0.05f, 1, 1, 1}).empty());
}

}  // namespace
}  // namespace bpa
