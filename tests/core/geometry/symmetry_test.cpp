// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/symmetry.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

Pose any_pose(RandomStream& random) {
  Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return {from_wxyz(q), 0.1 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())};
}

TEST(Symmetry, SampledElementsKeepTheAxisAndAreEvenlySpread) {
  SymmetryGroup group;
  EXPECT_EQ(sampled_elements(group, 8).size(), 1u);
  const Pose half_turn{Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero()};
  group.discrete = {half_turn};
  EXPECT_EQ(sampled_elements(group, 8).size(), 2u);
  group.continuous = {{Eigen::Vector3d::UnitZ(), {0.1, -0.2, 0}}};
  const std::vector<Pose> elements = sampled_elements(group, 8);
  ASSERT_EQ(elements.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    const Pose element = i < 8 ? elements[i] : half_turn.inverse() * elements[i];
    const Eigen::Vector3d on_axis(0.1, -0.2, 0.3);
    EXPECT_LT((element * on_axis - on_axis).norm(), 1e-12);
    if (i % 8 != 0) {
      EXPECT_NEAR(rotation_angle(elements[i].rotation, elements[i - 1].rotation), M_PI / 4, 1e-12);
    }
  }
  EXPECT_LT(pose_error(elements[0], Pose{}).angle, 1e-12) << "the identity is first";
}

TEST(Symmetry, WithoutSymmetryIsThePlainError) {
  RandomStream random(1);
  const Pose a = any_pose(random);
  const Pose b = any_pose(random);
  EXPECT_EQ(pose_error(a, b, SymmetryGroup{}).angle, pose_error(a, b).angle);
}

TEST(Symmetry, DiscreteTwinIsNoError) {
  RandomStream random(2);
  const Pose turn{rotation_from_vector({0, 0, M_PI}), {0.01, 0.02, 0}};
  const Pose truth = any_pose(random);
  const PoseError error = pose_error(truth * turn, truth, SymmetryGroup{{turn}, {}});
  EXPECT_LT(error.angle, 1e-9);
  EXPECT_LT(error.position, 1e-12);
}

// Oracle: the same group sampled at a thousand angles.
TEST(Symmetry, ContinuousAgreesWithFineSampling) {
  RandomStream random(3);
  const ContinuousSymmetry spin{Eigen::Vector3d(0.2, 0.3, 0.9).normalized(), {0.01, 0.0, 0.03}};
  for (int trial = 0; trial < 20; ++trial) {
    const Pose truth = any_pose(random);
    const Pose estimate = any_pose(random);
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 10000; ++i) {
      const Eigen::Quaterniond turn = rotation_from_vector(i * 2 * M_PI / 10000 * spin.axis);
      const Pose element{turn, spin.point - turn * spin.point};
      best = std::min(best, pose_error(estimate, truth * element).angle);
    }
    EXPECT_NEAR(pose_error(estimate, truth, SymmetryGroup{{}, {spin}}).angle, best, 1e-3);
  }
}

}  // namespace
}  // namespace bpa
