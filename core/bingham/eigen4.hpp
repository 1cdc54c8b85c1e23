// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace bpa {

/// The spectrum of a symmetric 4x4 matrix: values descending, an orthonormal column for each.
struct SymmetricEigen4 {
  Eigen::Vector4d values;
  Eigen::Matrix4d vectors;
};

/// Eigen's SelfAdjointEigenSolver with the values in descending order. `matrix` must be finite;
/// only its symmetric part counts.
SymmetricEigen4 symmetric_eigen(const Eigen::Matrix4d& matrix);

/// A unit eigenvector of the largest eigenvalue of a symmetric matrix. Its error is the rounding
/// error over the relative gap to the next eigenvalue. A clear gap takes Newton on the
/// characteristic polynomial from above, then inverse iteration; else symmetric_eigen(). bpa_mode()
/// calls it for every hypothesis: it takes a fifth of the time of symmetric_eigen().
Eigen::Vector4d dominant_eigenvector(const Eigen::Matrix4d& matrix);

}  // namespace bpa
