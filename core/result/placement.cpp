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

}  // namespace bpa
