// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Each error against a case worked out by hand.
#include "core/eval/pose_errors.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace bpa::eval {
namespace {

using std::numbers::pi;

Pose at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }
Pose turned_about_z(double angle) { return {rotation_from_vector({0, 0, angle}), {0, 0, 1}}; }

/// Corners of a square of 2 cm around the origin, in the plane z = 0.
Points square() {
  return {{0.01f, 0.01f, 0}, {-0.01f, 0.01f, 0}, {-0.01f, -0.01f, 0}, {0.01f, -0.01f, 0}};
}

TEST(PoseErrors, AddOfAShiftIsItsLength) {
  EXPECT_NEAR(average_distance(square(), at(0.003, 0.004, 1), at(0, 0, 1)), 0.005, 1e-9);
}

TEST(PoseErrors, AddOfAQuarterTurnIsTheSideButAddSIsNothing) {
  EXPECT_NEAR(average_distance(square(), turned_about_z(pi / 2), turned_about_z(0)), 0.02, 1e-8);
  EXPECT_NEAR(average_nearest_distance(square(), turned_about_z(pi / 2), turned_about_z(0)), 0,
              1e-8);
}

TEST(PoseErrors, AddSTakesTheNearestVertex) {
  // Shifted by 16 mm along x: two corners come within 4 mm of the corners of the other side, and
  // two are 16 mm from the nearest.
  const Pose shifted = at(0.016, 0, 1);
  EXPECT_NEAR(average_nearest_distance(square(), shifted, at(0, 0, 1)), 0.010, 1e-8);
}

TEST(PoseErrors, RmsOfAHalfTurnIsTheDiagonalUnlessSymmetric) {
  const double diagonal = 0.02 * std::sqrt(2.0);
  EXPECT_NEAR(rms_distance(square(), turned_about_z(pi), turned_about_z(0), {Pose{}}), diagonal,
              1e-8);
  SymmetryGroup group;
  group.discrete = {{rotation_from_vector({0, 0, pi}), Eigen::Vector3d::Zero()}};
  EXPECT_NEAR(
      rms_distance(square(), turned_about_z(pi), turned_about_z(0), discretised_symmetries(group)),
      0, 1e-8);
}

TEST(PoseErrors, MssdIsTheLargestDistance) {
  // A turn about the corner (0.01, 0.01) by 60 degrees moves the opposite one by the diagonal.
  const Eigen::Quaterniond turn = rotation_from_vector({0, 0, pi / 3});
  const Eigen::Vector3d corner(0.01, 0.01, 0);
  const Pose about_corner{turn, corner - turn * corner + Eigen::Vector3d(0, 0, 1)};
  EXPECT_NEAR(max_surface_distance(square(), about_corner, at(0, 0, 1), {Pose{}}),
              0.02 * std::sqrt(2.0), 1e-8);
}

TEST(PoseErrors, MspdIsInPixels) {
  const Camera camera{640, 480, 500, 400, 320, 240};
  // 10 mm at 1 m: 5 pixels across, 4 pixels down.
  EXPECT_NEAR(max_projection_distance(square(), at(0.01, 0, 1), at(0, 0, 1), {Pose{}}, camera), 5,
              1e-4);
  EXPECT_NEAR(max_projection_distance(square(), at(0, 0.01, 1), at(0, 0, 1), {Pose{}}, camera), 4,
              1e-4);
  EXPECT_TRUE(
      std::isinf(max_projection_distance(square(), at(0, 0, -1), at(0, 0, 1), {Pose{}}, camera)));
}

TEST(PoseErrors, RightIsWithinBothTolerancesModuloSymmetry) {
  const Pose truth = at(0, 0, 1);
  EXPECT_TRUE(is_right(at(0.024, 0, 1), truth, {}));
  EXPECT_FALSE(is_right(at(0.026, 0, 1), truth, {}));
  EXPECT_FALSE(is_right(at(1, 0, 1), truth, {}));
  EXPECT_TRUE(is_right(turned_about_z(pi / 17), truth, {}));
  EXPECT_FALSE(is_right(turned_about_z(pi / 15), truth, {}));
  SymmetryGroup half_turn;
  half_turn.discrete = {{rotation_from_vector({0, 0, pi}), {0, 0, 0}}};
  EXPECT_FALSE(is_right(turned_about_z(pi), truth, {}));
  EXPECT_TRUE(is_right(turned_about_z(pi), truth, half_turn));
  // The symmetry may move the origin, by a part of the object's size.
  half_turn.discrete[0].translation = {0.1, 0, 0};
  Pose moved = turned_about_z(pi);
  moved.translation.x() = 0.1;
  EXPECT_TRUE(is_right(moved, truth, half_turn));
}

TEST(PoseErrors, ContinuousSymmetryIsCutInto315Steps) {
  SymmetryGroup group;
  group.continuous = {{Eigen::Vector3d::UnitZ(), {0.5, 0, 0}}};
  const std::vector<Pose> poses = discretised_symmetries(group);
  ASSERT_EQ(poses.size(), 315u);
  EXPECT_LT(pose_error(poses[0], Pose{}).angle, 1e-9);
  // Every one keeps the axis where it is.
  for (const Pose& pose : poses) {
    EXPECT_LT((pose * Eigen::Vector3d(0.5, 0, 3) - Eigen::Vector3d(0.5, 0, 3)).norm(), 1e-12);
  }
}

TEST(DepthRender, ATiltedTriangleAgainstItsPlane) {
  const Camera camera{64, 48, 50, 50, 31.5, 23.5};
  TriangleMesh mesh;
  mesh.vertices = {{-0.5f, -0.4f, 0.9f}, {0.6f, -0.3f, 1.2f}, {0, 0.5f, 1.0f}};
  mesh.triangles = {{0, 1, 2}};
  const std::vector<float> depth = render_depth(mesh, Pose{}, camera);
  const Eigen::Vector3d a = mesh.vertices[0].cast<double>();
  const Eigen::Vector3d normal = (mesh.vertices[1] - mesh.vertices[0])
                                     .cross(mesh.vertices[2] - mesh.vertices[0])
                                     .cast<double>();
  int covered = 0;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const float z = depth[static_cast<std::size_t>(64 * v + u)];
      if (z == 0) continue;
      ++covered;
      const Eigen::Vector3d ray = camera.unproject(u, v, 1);
      EXPECT_NEAR(z, normal.dot(a) / normal.dot(ray), 1e-5);
    }
  }
  // The area of the projected triangle.
  const Eigen::Vector2d p = camera.project(a);
  const Eigen::Vector2d q = camera.project(mesh.vertices[1].cast<double>()) - p;
  const Eigen::Vector2d r = camera.project(mesh.vertices[2].cast<double>()) - p;
  EXPECT_NEAR(covered, 0.5 * std::abs(q.x() * r.y() - q.y() * r.x()), 25);
}

TEST(DepthRender, TheNearerSurfaceWins) {
  const Camera camera{16, 16, 16, 16, 7.5, 7.5};
  TriangleMesh mesh;
  for (const float z : {2.0f, 1.0f, 3.0f}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{-9, -9, z}, {9, -9, z}, {0, 9, z}});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_FLOAT_EQ(render_depth(mesh, Pose{}, camera)[8 * 16 + 8], 1);
}

/// Depth images of 4 x 1 pixels along the optical axis, so that depth is nearly distance.
TEST(Vsd, FourPixelsByHand) {
  const Camera camera{4, 1, 1e6, 1e6, 1.5, 0};
  // pixel 0: both, 4 mm apart   pixel 1: only the estimate   pixel 2: both, equal
  // pixel 3: both behind something: out
  const std::vector<float> estimate = {1.004f, 1.0f, 1.0f, 1.0f};
  const std::vector<float> truth = {1.0f, 0, 1.0f, 1.0f};
  const std::vector<float> measured = {1.0f, 1.0f, 0, 0.9f};
  const std::array<double, 10> errors =
      visible_surface_discrepancy(estimate, truth, measured, camera, 0.05);
  // 4 mm is 0.08 diameters: wrong at tolerance 0.05, right at 0.10. The union has 3 pixels.
  EXPECT_NEAR(errors[0], 2.0 / 3, 1e-12);
  EXPECT_NEAR(errors[1], 1.0 / 3, 1e-12);
  EXPECT_NEAR(errors[9], 1.0 / 3, 1e-12);
}

TEST(Vsd, WhatIsNotSeenAtAllIsWrong) {
  const Camera camera{1, 1, 1e6, 1e6, 0, 0};
  EXPECT_EQ(visible_surface_discrepancy({0}, {0}, {1}, camera, 0.1)[0], 1);
  EXPECT_EQ(visible_surface_discrepancy({1}, {1}, {0.5f}, camera, 0.1)[9], 1);
  EXPECT_EQ(visible_surface_discrepancy({1}, {1}, {1}, camera, 0.1)[0], 0);
}

}  // namespace
}  // namespace bpa::eval
