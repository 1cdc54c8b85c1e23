// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/result/placement.hpp"

#include <Eigen/Eigenvalues>

namespace bpa {

// A small rotation by d about the camera's axes has the quaternion (1, d / 2), so that a Gaussian
// of covariance C in d is a Bingham with the exponent -2 v^T C^-1 v in v = d / 2.
OrientationUncertainty orientation_uncertainty(const Eigen::Quaterniond& rotation,
                                               const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  OrientationUncertainty out;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = solver.eigenvectors().col(k);
    const Eigen::Quaterniond turned =
        Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()) * rotation;
    out.axes.col(k) = to_wxyz(turned);
    out.concentrations[k] = -2 / solver.eigenvalues()[k];
  }
  return out;
}

double own_weight(const Placement& placement) {
  double own = 1;
  for (const PoseAlternative& other : placement.alternatives) own -= other.weight;
  return own;
}

bool pose_is_open(const Placement& placement) { return own_weight(placement) < 0.5; }

Placement transformed(const Pose& a_from_b, const Placement& placement) {
  const bool same = a_from_b.rotation.coeffs() == Eigen::Quaterniond::Identity().coeffs() &&
                    a_from_b.translation.isZero(0);
  Placement out = placement;
  if (same) return out;
  out.frame_from_object = a_from_b * placement.frame_from_object;
  for (PoseAlternative& other : out.alternatives) {
    other.frame_from_object = a_from_b * other.frame_from_object;
  }
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = a_from_b.matrix();
  turn.bottomRightCorner<3, 3>() = a_from_b.matrix();
  out.covariance = turn * placement.covariance * turn.transpose();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector4d axis = placement.orientation.axes.col(i);
    const Eigen::Quaterniond turned =
        a_from_b.rotation * Eigen::Quaterniond(axis[0], axis[1], axis[2], axis[3]);
    out.orientation.axes.col(i) = to_wxyz(turned);
  }
  return out;
}

}  // namespace bpa
