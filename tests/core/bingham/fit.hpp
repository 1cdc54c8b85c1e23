// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <span>

#include "core/bingham/bingham.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa {

inline Eigen::Vector4d with_zero(const Eigen::Vector3d& lambda) {
  return {0, lambda[0], lambda[1], lambda[2]};
}

// The concentrations (0, λ1, λ2, λ3) with ∂ log F / ∂λi = τi.
inline Eigen::Vector4d solve_concentrations(const Eigen::Vector4d& tau) {
  // Right for the uniform distribution and in the limit of concentration.
  Eigen::Vector3d lambda;
  for (int i = 0; i < 3; ++i) lambda[i] = -0.5 * (1 / tau[i + 1] - 1 / tau[0]);
  const auto objective = [&tau](const Eigen::Vector3d& at) {
    return bingham_log_normalizer(with_zero(at)) - at.dot(tau.tail<3>());
  };
  double value = objective(lambda);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const BinghamNormalizer n = bingham_normalizer(with_zero(lambda));
    const Eigen::Vector3d gradient = n.gradient.tail<3>() - tau.tail<3>();
    if ((gradient.array().abs() < 1e-13 * tau.tail<3>().array()).all()) break;
    const Eigen::Matrix3d hessian = n.fourth.bottomRightCorner<3, 3>() -
                                    n.gradient.tail<3>() * n.gradient.tail<3>().transpose();
    // Scaled by the standard deviations, so that concentrations of any size are solved alike.
    const Eigen::Vector3d scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
    const Eigen::Vector3d step =
        scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
    double length = 1;
    for (; length > 1e-3; length *= 0.5) {
      const Eigen::Vector3d next = lambda - length * step;
      const double next_value = objective(next);
      if (next_value <= value + 1e-15 * std::abs(value)) {
        lambda = next;
        value = next_value;
        break;
      }
    }
    if (length <= 1e-3) break;  // Rounding error is all that is left.
  }
  return with_zero(lambda);
}

/// The Bingham whose scatter E[q qᵀ] is the given one, of trace 1: the maximum likelihood fit to
/// samples with that mean of q qᵀ. Newton's method on log F(λ) - λ · τ, which is convex.
/// Eigenvalues τ of the scatter below 1e-12, as of fewer than four samples, count as 1e-12.
inline Bingham fit_bingham(const Eigen::Matrix4d& scatter) {
  const SymmetricEigen4 spectrum = symmetric_eigen(scatter);
  Eigen::Vector4d tau = spectrum.values.cwiseMax(1e-12);
  tau /= tau.sum();
  const Eigen::Vector4d lambda = solve_concentrations(tau);
  return Bingham::from_exponent(spectrum.vectors * lambda.asDiagonal() *
                                spectrum.vectors.transpose());
}

/// The maximum likelihood fit to unit quaternions (signs do not matter), optionally weighted.
/// Uniform for none. `weights` is empty or as long as `samples`, not negative, any positive sum.
inline Bingham fit_bingham(std::span<const Eigen::Quaterniond> samples,
                           std::span<const double> weights = {}) {
  assert(weights.empty() || weights.size() == samples.size());
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  double total = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Quaterniond& s = samples[i];
    const Eigen::Vector4d q(s.w(), s.x(), s.y(), s.z());
    const double weight = weights.empty() ? 1 : weights[i];
    scatter += weight * q * q.transpose();
    total += weight;
  }
  return total > 0 ? fit_bingham(Eigen::Matrix4d(scatter / total)) : Bingham();
}

}  // namespace bpa
