// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa {
namespace {

using Cell = std::array<int, 3>;

Cell cell_of(const Eigen::Vector3f& p, float spacing) {
  Cell cell;
  for (int k = 0; k < 3; ++k) {
    cell[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(p[k] * (1 / spacing)));
  }
  return cell;
}

PointCloud random_cloud(int count) {
  RandomStream random(3);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points.push_back(
        Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
            .cast<float>() *
        0.05f);
  }
  return cloud;
}

TEST(Downsample, TakesTheMeanOfEveryCube) {
  PointCloud cloud = random_cloud(3000);
  RandomStream random(4);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.colors.push_back({static_cast<std::uint8_t>(random.index(256)),
                            static_cast<std::uint8_t>(random.index(256)), 9});
  }
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), color = Eigen::Vector3d::Zero();
    int count = 0;
  };
  constexpr float kSpacing = 0.011f;
  std::map<Cell, Sum> expected;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Sum& sum = expected[cell_of(cloud.points[i], kSpacing)];
    sum.point += cloud.points[i].cast<double>();
    sum.color += Eigen::Vector3d(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]);
    ++sum.count;
  }
  const PointCloud even = downsample(cloud, kSpacing);
  ASSERT_EQ(even.size(), expected.size());
  ASSERT_EQ(even.colors.size(), expected.size());
  EXPECT_TRUE(even.normals.empty());
  for (std::size_t i = 0; i < even.size(); ++i) {
    const auto found = expected.find(cell_of(even.points[i], kSpacing));
    ASSERT_NE(found, expected.end());
    const Sum& sum = found->second;
    EXPECT_LT((sum.point / sum.count - even.points[i].cast<double>()).norm(), 1e-7);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(sum.color[k] / sum.count, even.colors[i][static_cast<std::size_t>(k)], 0.501);
    }
    expected.erase(found);
  }
}

TEST(Downsample, KeepsBothSidesOfAThinWall) {
  PointCloud wall;
  constexpr float kThickness = 0.001f;
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 50; ++x) {
      const Eigen::Vector3f p(0.001f * static_cast<float>(x), 0.001f * static_cast<float>(y),
                              0.002f);
      wall.points.push_back(p);
      wall.normals.push_back(-Eigen::Vector3f::UnitZ());
      wall.points.push_back(p + kThickness * Eigen::Vector3f::UnitZ());
      wall.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  const PointCloud even = downsample(wall, 0.005f);
  ASSERT_EQ(even.size(), 200u);  // 10 x 10 cubes, two sides
  for (std::size_t i = 0; i < even.size(); ++i) {
    const bool upper = even.normals[i].z() > 0;
    EXPECT_NEAR(even.points[i].z(), upper ? 0.003f : 0.002f, 1e-6f);
    EXPECT_NEAR(std::abs(even.normals[i].z()), 1, 1e-6f);
  }
}

TEST(Downsample, PointsWithoutANormalDoNotMoveTheOthers) {
  PointCloud cloud;
  cloud.points = {{0.001f, 0.001f, 0.001f}, {0.004f, 0.001f, 0.001f}, {0.021f, 0, 0}};
  cloud.normals = {Eigen::Vector3f::UnitX(), Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  const PointCloud even = downsample(cloud, 0.005f);
  ASSERT_EQ(even.size(), 1u);
  EXPECT_LT((even.points[0] - cloud.points[0]).norm(), 1e-7f);
  EXPECT_EQ(even.normals[0], Eigen::Vector3f(Eigen::Vector3f::UnitX()));
}

TEST(Downsample, AveragesNormalsOfOneSide) {
  PointCloud cloud;
  cloud.points = {{0.001f, 0, 0}, {0.002f, 0, 0}};
  cloud.normals = {Eigen::Vector3f(0.6f, 0, 0.8f), Eigen::Vector3f(-0.6f, 0, 0.8f)};
  const PointCloud even = downsample(cloud, 0.005f);
  ASSERT_EQ(even.size(), 1u);
  EXPECT_LT((even.normals[0] - Eigen::Vector3f::UnitZ()).norm(), 1e-6f);
}

TEST(Downsample, NothingOfNothing) { EXPECT_TRUE(downsample(PointCloud{}, 0.01f).empty()); }

}  // namespace
}  // namespace bpa
