// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/symmetry.hpp"

// Whether errors of poses are as large as their covariances say.

namespace bpa::eval {

/// An error in units of its covariance.
struct CovarianceError {
  double squared = 0;          ///< Squared Mahalanobis length (normalised error squared, NEES).
  int degrees_of_freedom = 6;  ///< A turn that changes nothing does not count: 3 to 6.
};

/// The error of `estimate` under the covariance of (x, y, z, rotation about x, y, z), without its
/// part along the motions that the symmetry leaves free. `truth` is the symmetric one nearest to
/// the estimate. Nothing where the covariance is not positive definite.
std::optional<CovarianceError> covariance_error(const Pose& estimate,
                                                const Eigen::Matrix<double, 6, 6>& covariance,
                                                const Pose& truth, const SymmetryGroup& symmetry);

/// Levels of chi_squared_quantile().
constexpr double kCredibleLevels[] = {0.50, 0.90, 0.95};

/// The quantile of the chi-squared distribution at one of kCredibleLevels, by its index, with 3 to
/// 6 degrees of freedom.
double chi_squared_quantile(int level, int degrees_of_freedom);

}  // namespace bpa::eval
