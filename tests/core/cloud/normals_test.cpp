// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/normals.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "tests/support/meshes.hpp"

namespace bpa {
namespace {

const float kNan = std::nanf("");

PointCloud points_of_sphere(double radius, int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.normals.push_back(sphere_direction(i, count).cast<float>());
    cloud.points.emplace_back(static_cast<float>(radius) * cloud.normals.back());
  }
  return cloud;
}

TEST(Normals, OfASphereSeenFromItsMiddlePointInwards) {
  PointCloud cloud = points_of_sphere(0.08, 20000);
  const PointCloud truth = cloud;
  estimate_normals(cloud, 0.01f, Eigen::Vector3f::Zero(), 0);
  for (std::size_t i = 0; i < cloud.size(); i += 13) {
    EXPECT_GT(-cloud.normals[i].dot(truth.normals[i]), std::cos(0.03));
  }
  const Eigen::Vector3f far(0, 0, 10);
  estimate_normals(cloud, 0.01f, far, 0);
  for (std::size_t i = 0; i < cloud.size(); i += 13) {
    EXPECT_GE(cloud.normals[i].dot(far - cloud.points[i]), 0);
  }
}

TEST(Normals, OfTwoPointsAreUnknown) {
  PointCloud cloud;
  cloud.points = {{0, 0, 1}, {0.001f, 0, 1}};
  estimate_normals(cloud, 0.01f, Eigen::Vector3f::Zero(), 0);
  for (const Eigen::Vector3f& n : cloud.normals) EXPECT_EQ(n.squaredNorm(), 0);
  PointCloud empty;
  estimate_normals(empty, 0.01f, Eigen::Vector3f::Zero(), 0);
}

/// A ball with the normals that a file has.
TriangleMesh ball(const std::function<Eigen::Vector3f(std::size_t, const Eigen::Vector3f&)>& set) {
  TriangleMesh mesh = test::sphere_mesh(0.05);
  mesh.normals.clear();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.normals.push_back(set(i, mesh.vertices[i].normalized()));
  }
  mend_normals(mesh);
  return mesh;
}

TEST(MendNormals, OfAMeshGoWhereTheyCannotBeUsed) {
  RandomStream random(1);
  const auto noise = [&] { return static_cast<float>(random.normal()); };
  const auto has_none = [](const auto& set) { return ball(set).normals.empty(); };
  EXPECT_TRUE(has_none([](auto, auto&) { return Eigen::Vector3f(0, 0, 0); }));
  EXPECT_TRUE(has_none([](auto, auto&) { return Eigen::Vector3f(kNan, kNan, kNan); }));
  EXPECT_TRUE(has_none([](auto, auto&) { return Eigen::Vector3f(0, 0, 1); }));
  EXPECT_TRUE(has_none(
      [&](auto, auto&) { return Eigen::Vector3f(noise(), noise(), noise()).normalized().eval(); }));
  // Every third: more than a fifth.
  EXPECT_TRUE(has_none([](std::size_t i, const Eigen::Vector3f& n) {
    return Eigen::Vector3f(i % 3 == 0 ? Eigen::Vector3f(0, 0, 0) : n);
  }));
}

TEST(MendNormals, AFewAreReplacedByTheWinding) {
  for (const float side : {1.0f, -1.0f}) {  // also of a mesh whose triangles face inwards
    const TriangleMesh mesh = ball([&](std::size_t i, const Eigen::Vector3f& n) -> Eigen::Vector3f {
      if (i % 10 == 3) return {0, 0, 0};
      if (i % 10 == 7) return {kNan, 0, 1};
      return side * n;
    });
    ASSERT_FALSE(mesh.normals.empty());
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto& v = mesh.vertices;
      if ((v[b] - v[a]).cross(v[c] - v[a]).norm() < 1e-8f) continue;  // at a pole
      const std::size_t i = c;
      EXPECT_GT(side * mesh.normals[i].dot(mesh.vertices[i].normalized()), 0.98f);
    }
  }
}

TEST(MendNormals, GoodOnesStayToTheBit) {
  const auto given = [](auto, const Eigen::Vector3f& n) {
    return (n + Eigen::Vector3f(0.3f, 0, 0)).normalized().eval();
  };
  const TriangleMesh mesh = ball(given);
  ASSERT_FALSE(mesh.normals.empty());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_EQ(mesh.normals[i], given(i, mesh.vertices[i].normalized()));
  }
}

}  // namespace
}  // namespace bpa
