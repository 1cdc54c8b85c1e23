// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/bingham.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

Vector4d wxyz(const Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

// The width b of the envelope: the root of Σ 1 / (b - 2 λi) = 1, in [1, 4]. It decides how many
// proposals are rejected, not what is drawn, so a few Newton steps do.
double envelope_width(const Vector4d& lambda) {
  double b = 1;
  for (int i = 0; i < 6; ++i) {
    double value = -1, slope = 0;
    for (int k = 0; k < 4; ++k) {
      const double term = 1 / (b - 2 * lambda[k]);
      value += term;
      slope += term * term;
    }
    b += value / slope;
    if (value < 1e-3) break;
  }
  return b < 4 ? b : 4;
}

}  // namespace

Bingham::Bingham(const SymmetricEigen4& spectrum) : axes_(spectrum.vectors) {
  lambda_ = spectrum.values.array() - spectrum.values[0];
}

Bingham Bingham::from_exponent(const Matrix4d& exponent) {
  return Bingham(symmetric_eigen(exponent));
}

Bingham Bingham::from_axes(const Vector3d& lambda, const Eigen::Matrix<double, 4, 3>& axes) {
  return from_exponent(axes * lambda.asDiagonal() * axes.transpose());
}

Bingham Bingham::about(const Quaterniond& mode, const Vector3d& lambda) {
  SymmetricEigen4 spectrum;
  spectrum.values << 0, lambda;
  spectrum.vectors = left_product(mode);
  for (int i = 1; i < 4; ++i) {  // Insertion sort, descending.
    for (int k = i; k > 0 && spectrum.values[k] > spectrum.values[k - 1]; --k) {
      std::swap(spectrum.values[k], spectrum.values[k - 1]);
      spectrum.vectors.col(k).swap(spectrum.vectors.col(k - 1));
    }
  }
  return Bingham(spectrum);
}

Quaterniond Bingham::mode() const {
  return Quaterniond(axes_(0, 0), axes_(1, 0), axes_(2, 0), axes_(3, 0));
}

Matrix4d Bingham::exponent() const { return axes_ * lambda_.asDiagonal() * axes_.transpose(); }

double Bingham::log_normalizer() const { return bingham_log_normalizer(lambda_); }

double Bingham::log_ratio_to_mode(const Quaterniond& q) const {
  const Vector4d x = axes_.transpose() * wxyz(q);
  return lambda_.dot(x.cwiseAbs2());
}

Matrix4d Bingham::scatter() const {
  return axes_ * bingham_normalizer(lambda_).gradient.asDiagonal() * axes_.transpose();
}

Bingham Bingham::rotated_right(const Quaterniond& r) const {
  return Bingham({lambda_, right_product(r) * axes_});
}

Quaterniond Bingham::sample(RandomStream& random, int* trials) const {
  const Vector4d q = axes_ * sample_diagonal_bingham(lambda_, random, trials);
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

Bingham product(const Bingham& a, const Bingham& b) {
  return Bingham::from_exponent(a.exponent() + b.exponent());
}

Bingham product(std::span<const Bingham> factors) {
  Matrix4d sum = Matrix4d::Zero();
  for (const Bingham& factor : factors) sum += factor.exponent();
  return Bingham::from_exponent(sum);
}

Vector4d sample_diagonal_bingham(const Vector4d& lambda, RandomStream& random, int* trials) {
  // Envelope (xᵀ Ω x)^-2 with Ω = I - 2 Λ / b; exp(-s) (1 + 2 s / b)² is at most
  // exp(-(4 - b) / 2) (4 / b)² for s = -Σ λi xi² ≥ 0.
  const double b = envelope_width(lambda);
  const double quarter_b = 0.25 * b;
  const double offset = 0.5 * (4 - b);
  const Vector4d inverse_sqrt = (1 - lambda.array() * (2 / b)).rsqrt();
  for (;;) {
    if (trials != nullptr) ++*trials;
    Vector4d x;
    for (int i = 0; i < 4; ++i) x[i] = random.normal() * inverse_sqrt[i];
    const double squared = x.squaredNorm();
    if (!(squared > 0)) continue;
    x *= 1 / std::sqrt(squared);
    const double s = -lambda.dot(x.cwiseAbs2());
    const double ratio = quarter_b + 0.5 * s;
    if (random.uniform() < std::exp(offset - s) * ratio * ratio) return x;
  }
}

Matrix4d left_product(const Quaterniond& r) {
  Matrix4d m;
  m << r.w(), -r.x(), -r.y(), -r.z(),  //
      r.x(), r.w(), -r.z(), r.y(),     //
      r.y(), r.z(), r.w(), -r.x(),     //
      r.z(), -r.y(), r.x(), r.w();
  return m;
}

Matrix4d right_product(const Quaterniond& r) {
  Matrix4d m;
  m << r.w(), -r.x(), -r.y(), -r.z(),  //
      r.x(), r.w(), r.z(), -r.y(),     //
      r.y(), -r.z(), r.w(), r.x(),     //
      r.z(), r.y(), -r.x(), r.w();
  return m;
}

double BinghamMixture::log_density(const Eigen::Quaterniond& q) const {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Component& c : components) {
    largest = std::max(largest, std::log(c.weight) + c.bingham.log_density(q));
  }
  double sum = 0;
  for (const Component& c : components) {
    sum += std::exp(std::log(c.weight) + c.bingham.log_density(q) - largest);
  }
  return largest + std::log(sum);
}

Eigen::Quaterniond BinghamMixture::sample(RandomStream& random) const {
  double left = random.uniform();
  for (const Component& c : components) {
    left -= c.weight;
    if (left < 0) return c.bingham.sample(random);
  }
  return components.empty() ? Bingham().sample(random) : components.back().bingham.sample(random);
}

}  // namespace bpa
