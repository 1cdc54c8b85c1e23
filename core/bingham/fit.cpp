// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/fit.hpp"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

Vector4d with_zero(const Vector3d& lambda) { return {0, lambda[0], lambda[1], lambda[2]}; }

// The concentrations (0, λ1, λ2, λ3) with ∂ log F / ∂λi = τi.
Vector4d solve_concentrations(const Vector4d& tau) {
  // Right for the uniform distribution and in the limit of concentration.
  Vector3d lambda;
  for (int i = 0; i < 3; ++i) lambda[i] = -0.5 * (1 / tau[i + 1] - 1 / tau[0]);
  const auto objective = [&tau](const Vector3d& at) {
    return bingham_log_normalizer(with_zero(at)) - at.dot(tau.tail<3>());
  };
  double value = objective(lambda);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const BinghamNormalizer n = bingham_normalizer(with_zero(lambda));
    const Vector3d gradient = n.gradient.tail<3>() - tau.tail<3>();
    if ((gradient.array().abs() < 1e-13 * tau.tail<3>().array()).all()) break;
    const Matrix3d hessian = n.fourth.bottomRightCorner<3, 3>() -
                             n.gradient.tail<3>() * n.gradient.tail<3>().transpose();
    // Scaled by the standard deviations, so that concentrations of any size are solved alike.
    const Vector3d scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix3d scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
    const Vector3d step = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
    double length = 1;
    for (; length > 1e-3; length *= 0.5) {
      const Vector3d next = lambda - length * step;
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

}  // namespace

Bingham fit_bingham(const Matrix4d& scatter) {
  const SymmetricEigen4 spectrum = symmetric_eigen(scatter);
  Vector4d tau = spectrum.values.cwiseMax(1e-12);
  tau /= tau.sum();
  const Vector4d lambda = solve_concentrations(tau);
  return Bingham::from_exponent(spectrum.vectors * lambda.asDiagonal() *
                                spectrum.vectors.transpose());
}

Bingham fit_bingham(std::span<const Quaterniond> samples, std::span<const double> weights) {
  assert(weights.empty() || weights.size() == samples.size());
  Matrix4d scatter = Matrix4d::Zero();
  double total = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Quaterniond& s = samples[i];
    const Vector4d q(s.w(), s.x(), s.y(), s.z());
    const double weight = weights.empty() ? 1 : weights[i];
    scatter += weight * q * q.transpose();
    total += weight;
  }
  return total > 0 ? fit_bingham(Matrix4d(scatter / total)) : Bingham();
}

}  // namespace bpa
