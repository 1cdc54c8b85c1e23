// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/covariance_error.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace bpa::eval {
namespace {

using Twist = Eigen::Matrix<double, 6, 1>;  // position, then turn; camera frame

/// The small motions of an object at a pose that change nothing: a turn about each continuous axis.
std::vector<Twist> free_motions(const Pose& pose, const SymmetryGroup& symmetry) {
  std::vector<Eigen::Vector3d> axes;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (const ContinuousSymmetry& continuous : symmetry.continuous) {
    const Eigen::Vector3d axis = (pose.rotation * continuous.axis).normalized();
    point = pose.rotation * continuous.point;
    const auto alike = [&](const auto& other) { return std::abs(other.dot(axis)) > 1 - 1e-9; };
    if (std::ranges::none_of(axes, alike)) axes.push_back(axis);
  }
  // Two axes make a ball, which may turn in any way.
  if (axes.size() > 1) axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Twist> motions;
  for (const Eigen::Vector3d& axis : axes) {
    Twist motion;
    motion << point.cross(axis), axis;
    motions.push_back(motion);
  }
  return motions;
}

}  // namespace

std::optional<CovarianceError> covariance_error(const Pose& estimate,
                                                const Eigen::Matrix<double, 6, 6>& covariance,
                                                const Pose& truth, const SymmetryGroup& symmetry) {
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Twist error;
  error << truth.translation - estimate.translation,
      vector_from_rotation((truth.rotation * estimate.rotation.conjugate()).normalized());
  factor.matrixL().solveInPlace(error);
  std::vector<Twist> free = free_motions(estimate, symmetry);
  for (auto motion = free.begin(); motion != free.end(); ++motion) {
    factor.matrixL().solveInPlace(*motion);
    for (auto earlier = free.begin(); earlier != motion; ++earlier) {
      *motion -= earlier->dot(*motion) * *earlier;
    }
    motion->normalize();
    error -= motion->dot(error) * *motion;
  }
  return CovarianceError{error.squaredNorm(), 6 - static_cast<int>(free.size())};
}

double chi_squared_quantile(int level, int degrees_of_freedom) {
  constexpr double kQuantiles[][4] = {{2.3660, 3.3567, 4.3515, 5.3481},
                                      {6.2514, 7.7794, 9.2364, 10.6446},
                                      {7.8147, 9.4877, 11.0705, 12.5916}};
  return kQuantiles[level][degrees_of_freedom - 3];
}

}  // namespace bpa::eval
