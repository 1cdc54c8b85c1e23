// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

Pose random_pose(RandomStream& random) {
  Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return {from_wxyz(q), Eigen::Vector3d(random.normal(), random.normal(), random.normal())};
}

TEST(Pose, AgreesWithHomogeneousMatrices) {
  RandomStream random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    Eigen::Isometry3d matrix_a = Eigen::Translation3d(a.translation) * a.rotation;
    Eigen::Isometry3d matrix_b = Eigen::Translation3d(b.translation) * b.rotation;
    const Eigen::Vector3d point(random.normal(), random.normal(), random.normal());
    EXPECT_TRUE(((a * b) * point).isApprox(matrix_a * matrix_b * point, 1e-12));
    EXPECT_TRUE((a.inverse() * point).isApprox(matrix_a.inverse() * point, 1e-12));
    EXPECT_LT(rotation_angle(Pose::from_matrix(matrix_a.matrix()).rotation, a.rotation), 1e-9);
  }
}

TEST(Pose, RotationVectorsRoundTrip) {
  RandomStream random(2);
  for (double angle : {0.0, 1e-13, 1e-9, 1e-4, 0.5, 3.0, M_PI - 1e-9}) {
    const Eigen::Vector3d axis =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Quaterniond rotation = rotation_from_vector(angle * axis);
    EXPECT_NEAR(rotation_angle(rotation, Eigen::Quaterniond::Identity()), angle,
                1e-15 + 1e-9 * angle);
    EXPECT_LT((vector_from_rotation(rotation) - angle * axis).norm(), 1e-12);
    const Eigen::Quaterniond negated(-rotation.w(), -rotation.x(), -rotation.y(), -rotation.z());
    EXPECT_LT((vector_from_rotation(negated) - angle * axis).norm(), 1e-12);
  }
}

TEST(Pose, NearestRotationOfAScaledOrShearedMatrix) {
  Eigen::Matrix3d scaled = 1.01 * rotation_from_vector({0.3, -0.2, 0.9}).toRotationMatrix();
  const Pose pose = Pose::from_matrix(scaled, Eigen::Vector3d::Zero());
  EXPECT_TRUE(is_valid(pose));
  EXPECT_LT(rotation_angle(pose.rotation, rotation_from_vector({0.3, -0.2, 0.9})), 1e-9);
}

}  // namespace
}  // namespace bpa
