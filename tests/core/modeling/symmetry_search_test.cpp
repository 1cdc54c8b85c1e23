// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/symmetry_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"

namespace bpa::modeling {
namespace {

SymmetryGroup symmetries_of(const TriangleMesh& mesh) {
  const auto source = model_source_from_mesh(mesh, "thing", 1);
  EXPECT_TRUE(source.ok());
  return find_symmetries(source->surface, source->diameter, 0);
}

TEST(SymmetrySearch, BoxHasThreeHalfTurns) {
  const SymmetryGroup group = symmetries_of(test::box_mesh({0.05f, 0.04f, 0.025f}));
  EXPECT_TRUE(group.continuous.empty());
  ASSERT_EQ(group.discrete.size(), 3u) << describe(group);
  for (const Pose& pose : group.discrete) {
    const Eigen::Vector3d v = vector_from_rotation(pose.rotation);
    EXPECT_NEAR(v.norm(), M_PI, 0.02);
    EXPECT_GT(v.normalized().cwiseAbs().maxCoeff(), std::cos(0.02)) << "about an axis of the box";
    EXPECT_LT(pose.translation.norm(), 0.002);
  }
}

TEST(SymmetrySearch, CubeHasTwentyThreeTurns) {
  const SymmetryGroup group = symmetries_of(test::box_mesh({0.04f, 0.04f, 0.04f}));
  EXPECT_EQ(group.discrete.size(), 23u) << describe(group);
}

TEST(SymmetrySearch, BeakerTurnsAboutItsAxisOnly) {
  const SymmetryGroup group = symmetries_of(test::cup_mesh(0.04, 0.003, 0.09));
  ASSERT_EQ(group.continuous.size(), 1u) << describe(group);
  EXPECT_TRUE(group.discrete.empty()) << "it has a foot and a mouth";
  EXPECT_GT(group.continuous[0].axis.z(), std::cos(0.02));
  EXPECT_LT(group.continuous[0].point.head<2>().norm(), 0.001);
}

// Turned by 72 degrees, a square lies on itself but for its corners, which stick out in its plane.
TEST(SymmetrySearch, SquareSheetTurnsByRightAnglesOnly) {
  TriangleMesh sheet;
  test::add_quad(sheet, {-0.05f, -0.05f, 0}, {0.05f, -0.05f, 0}, {0.05f, 0.05f, 0},
                 {-0.05f, 0.05f, 0});
  const SymmetryGroup group = symmetries_of(sheet);
  EXPECT_TRUE(group.continuous.empty());
  EXPECT_EQ(group.discrete.size(), 7u) << describe(group);
  for (const Pose& pose : group.discrete) {
    const double quarters = vector_from_rotation(pose.rotation).norm() / (M_PI / 2);
    EXPECT_NEAR(quarters, std::round(quarters), 0.02) << describe(group);
  }
}

// A bowl as a scan gives it: noise on points and normals, and a part of the foot and of the wall
// never seen, which moves the mean of the points off the axis.
TEST(SymmetrySearch, ScannedBowlTurnsByAnyAngle) {
  std::vector<std::pair<double, double>> curve;
  for (int k = 0; k <= 24; ++k) {  // up the outside
    const double angle = 0.5 * M_PI * k / 24;
    curve.push_back({0.075 * std::sin(angle), 0.06 - 0.06 * std::cos(angle)});
  }
  for (int k = 24; k >= 0; --k) {  // down the inside
    const double angle = 0.5 * M_PI * k / 24;
    curve.push_back({0.071 * std::sin(angle), 0.06 - 0.056 * std::cos(angle)});
  }
  TriangleMesh mesh;
  test::add_lathe(mesh, curve);
  const auto source = model_source_from_mesh(mesh, "bowl", 1);
  ASSERT_TRUE(source.ok());
  PointCloud scan;
  RandomStream random(4);
  const auto noise = [&random](double sigma) {
    return Eigen::Vector3f(static_cast<float>(sigma * random.normal()),
                           static_cast<float>(sigma * random.normal()),
                           static_cast<float>(sigma * random.normal()));
  };
  for (std::size_t i = 0; i < source->surface.size(); ++i) {
    const Eigen::Vector3f &p = source->surface.points[i], &n = source->surface.normals[i];
    if (n.z() < 0 && p.x() > 0.02f && std::abs(p.y()) < 0.015f && p.z() < 0.03f) continue;
    scan.points.push_back(p + n * noise(0.0004).x());
    scan.normals.push_back((n + noise(0.1)).normalized());
  }
  ASSERT_LT(scan.size(), source->surface.size() * 99 / 100);
  const SymmetryGroup group = find_symmetries(scan, source->diameter, 0);
  ASSERT_EQ(group.continuous.size(), 1u) << describe(group);
  EXPECT_TRUE(group.discrete.empty()) << describe(group);
  EXPECT_GT(group.continuous[0].axis.z(), std::cos(0.03));
  EXPECT_LT(group.continuous[0].point.head<2>().norm(), 0.002);
}

// 15 teeth are turned onto one another by thirds and fifths, but not by any angle.
TEST(SymmetrySearch, GearKeepsItsTeeth) {
  TriangleMesh gear;
  constexpr int kTeeth = 15;
  for (const float side : {-1.0f, 1.0f}) {
    for (int k = 0; k < 2 * kTeeth; ++k) {
      const auto at = [&](int step, float z) {
        const float r = k % 2 == 0 ? 0.05f : 0.036f;
        const auto a = static_cast<float>(M_PI * step / kTeeth);
        return Eigen::Vector3f(r * std::cos(a), r * std::sin(a), z);
      };
      const float z = 0.01f * side;
      const Eigen::Vector3f middle(0, 0, z);
      const auto quad = [&gear](const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                const Eigen::Vector3f& c,
                                const Eigen::Vector3f& d) { test::add_quad(gear, a, b, c, d); };
      if (side > 0) {
        quad(middle, at(k, z), at(k + 1, z), middle);
        quad(at(k, -z), at(k + 1, -z), at(k + 1, z), at(k, z));
        const Eigen::Vector3f low = at(k, -z), high = at(k, z);
        const float ratio = k % 2 == 0 ? 0.036f / 0.05f : 0.05f / 0.036f;
        const Eigen::Vector3f scale(ratio, ratio, 1);
        quad(low.cwiseProduct(scale), low, high, high.cwiseProduct(scale));
      } else {
        quad(middle, at(k + 1, z), at(k, z), middle);
      }
    }
  }
  const SymmetryGroup group = symmetries_of(gear);
  EXPECT_TRUE(group.continuous.empty()) << describe(group);
  EXPECT_EQ(group.discrete.size(), 29u) << describe(group);  // 15 turns, each also upside down
}

TEST(SymmetrySearch, SphereTurnsAnyWay) {
  EXPECT_GE(symmetries_of(test::sphere_mesh(0.04)).continuous.size(), 2u);
}

TEST(SymmetrySearch, LHasOneHalfTurnAtMost) {
  // The two boxes of the L are equally wide, so that only a mirror maps it onto itself.
  const SymmetryGroup group = symmetries_of(test::l_mesh());
  EXPECT_TRUE(group.trivial()) << describe(group);
  EXPECT_EQ(describe(group), "none");
}

}  // namespace
}  // namespace bpa::modeling
