// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/curvature.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

constexpr float kRadius = 0.015f;  // of the neighbourhoods

// Points 1 mm apart on a cylinder about z.
PointCloud cylinder(double radius, double height) {
  PointCloud cloud;
  const int steps = static_cast<int>(2 * M_PI * radius / 0.001);
  for (int s = 0; s < steps; ++s) {
    const double angle = 2 * M_PI * s / steps;
    const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0);
    for (double z = 0; z < height; z += 0.001) {
      cloud.points.push_back((radius * normal + Eigen::Vector3d(0, 0, z)).cast<float>());
      cloud.normals.push_back(normal.cast<float>());
    }
  }
  return cloud;
}

PointCloud sphere(double radius, int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = M_PI * (3 - std::sqrt(5.0)) * i;
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d normal(r * std::cos(angle), r * std::sin(angle), z);
    cloud.points.push_back((radius * normal).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

PointCloud plate(float thickness) {
  PointCloud cloud;
  for (int k = 0; k < 40 * 40; ++k) {
    const Eigen::Vector3f p(0.002f * static_cast<float>(k % 40),
                            0.002f * static_cast<float>(k / 40), 0);
    cloud.points.push_back(p);
    cloud.normals.push_back(-Eigen::Vector3f::UnitZ());
    if (thickness <= 0) continue;
    cloud.points.push_back(p + thickness * Eigen::Vector3f::UnitZ());
    cloud.normals.push_back(Eigen::Vector3f::UnitZ());
  }
  return cloud;
}

void expect_tangent_directions(const PointCloud& cloud) {
  ASSERT_EQ(cloud.principal_directions.size(), cloud.size());
  ASSERT_EQ(cloud.curvatures.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_NEAR(cloud.principal_directions[i].norm(), 1, 1e-5);
    ASSERT_NEAR(cloud.principal_directions[i].dot(cloud.normals[i]), 0, 1e-5);
    ASSERT_GE(cloud.curvatures[i].x(), cloud.curvatures[i].y());
    ASSERT_GE(cloud.curvatures[i].y(), 0);
  }
}

TEST(Curvature, CylinderBendsAcrossItsAxisOnly) {
  constexpr double kCylinderRadius = 0.05;
  PointCloud cloud = cylinder(kCylinderRadius, 0.06);
  estimate_curvature(cloud, kRadius, 0);
  expect_tangent_directions(cloud);
  // Normals turn by s / R over the arc s; over a disc of radius r the mean of s^2 is r^2 / 4.
  const double expected = 0.25 * kRadius * kRadius / (kCylinderRadius * kCylinderRadius);
  for (std::size_t i = 0; i < cloud.size(); i += 7) {
    const float z = cloud.points[i].z();
    if (z < kRadius || z > 0.06f - kRadius) continue;
    EXPECT_LT(std::abs(cloud.principal_directions[i].z()), 0.02f);
    EXPECT_NEAR(cloud.curvatures[i].x(), expected, 0.06 * expected);
    EXPECT_LT(cloud.curvatures[i].y(), 1e-3 * expected);
  }
}

TEST(Curvature, SphereBendsAlikeInAllDirections) {
  constexpr double kSphereRadius = 0.06;
  PointCloud cloud = sphere(kSphereRadius, 20000);
  estimate_curvature(cloud, kRadius, 0);
  expect_tangent_directions(cloud);
  const double expected = 0.25 * kRadius * kRadius / (kSphereRadius * kSphereRadius);
  for (std::size_t i = 0; i < cloud.size(); i += 11) {
    EXPECT_NEAR(cloud.curvatures[i].x(), expected, 0.06 * expected);
    EXPECT_NEAR(cloud.curvatures[i].y(), expected, 0.06 * expected);
  }
}

TEST(Curvature, PlaneDoesNotBend) {
  PointCloud cloud = plate(0);
  estimate_curvature(cloud, kRadius, 0);
  expect_tangent_directions(cloud);
  for (const Eigen::Vector2f& c : cloud.curvatures) EXPECT_LT(c.x(), 1e-10f);
}

TEST(Curvature, FarSideOfAThinWallDoesNotCount) {
  PointCloud cloud = plate(0.002f);
  estimate_curvature(cloud, kRadius, 0);
  for (const Eigen::Vector2f& c : cloud.curvatures) EXPECT_LT(c.x(), 1e-10f);
}

TEST(Curvature, TakesEmptyAndTinyClouds) {
  PointCloud cloud;
  estimate_curvature(cloud, kRadius, 0);
  cloud.points = {{0, 0, 1}};
  cloud.normals = {-Eigen::Vector3f::UnitZ()};
  estimate_curvature(cloud, kRadius, 0);
  expect_tangent_directions(cloud);
}

TEST(Curvature, NumberOfThreadsDoesNotMatter) {
  PointCloud cloud = sphere(0.05, 5000);
  RandomStream random(1);
  for (Eigen::Vector3f& n : cloud.normals) {
    n = (n + 0.1f * Eigen::Vector3f(static_cast<float>(random.normal()), 0, 0)).normalized();
  }
  PointCloud one = cloud;
  estimate_curvature(one, kRadius, 1);
  for (const int threads : {2, 8}) {
    PointCloud many = cloud;
    estimate_curvature(many, kRadius, threads);
    EXPECT_EQ(one.principal_directions, many.principal_directions);
    EXPECT_EQ(one.curvatures, many.curvatures);
  }
}

}  // namespace
}  // namespace bpa
