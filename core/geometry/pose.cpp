// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace bpa {

Pose Pose::from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  if (nearest.determinant() < 0) {
    Eigen::Matrix3d u = svd.matrixU();
    u.col(2) *= -1;
    nearest = u * svd.matrixV().transpose();
  }
  return {Eigen::Quaterniond(nearest).normalized(), translation};
}

Pose Pose::from_matrix(const Eigen::Matrix4d& matrix) {
  return from_matrix(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>()),
                     Eigen::Vector3d(matrix.topRightCorner<3, 1>()));
}

double rotation_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  // atan2 keeps full precision for tiny angles, where acos does not.
  const Eigen::Quaterniond difference = a.conjugate() * b;
  return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const double half = 0.5 * angle;
  const double scale = angle < 1e-8 ? 0.5 - angle * angle / 48 : std::sin(half) / angle;
  return Eigen::Quaterniond(std::cos(half), scale * v.x(), scale * v.y(), scale * v.z())
      .normalized();
}

Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * sign * q.vec();
  return (2 * std::atan2(sine, std::abs(q.w())) / sine) * sign * q.vec();
}

bool is_valid(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1) < 1e-6;
}

}  // namespace bpa
