// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// An independent way to the Bingham normaliser: splitting S3 into two circles,
//
//   F = 2π² ∫₀¹ e^{(1-u)(λ0+λ1)/2} I0((1-u)(λ0-λ1)/2) e^{u(λ2+λ3)/2} I0(u(λ2-λ3)/2) du,
//
// by tanh-sinh quadrature, with the Bessel functions from their own integral or, for large
// arguments, their asymptotic series. Slow and plain.

namespace bpa::oracle {

/// e^-x I0(x) and e^-x (I0(x) - I1(x)) / 2, for x ≥ 0, without cancellation.
inline std::pair<double, double> scaled_bessel(double x) {
  if (x > 400) {
    double term0 = 1, term1 = 1, sum = 1, difference = 0;
    for (int k = 1; k < 12; ++k) {
      const double odd = (2 * k - 1) * (2 * k - 1);
      term0 *= odd / (8 * k * x);
      term1 *= (odd - 4) / (8 * k * x);
      sum += term0;
      difference += term0 - term1;
    }
    const double factor = 1 / std::sqrt(2 * M_PI * x);
    return {factor * sum, 0.5 * factor * difference};
  }
  const int n = 40 + static_cast<int>(10 * std::sqrt(x));  // Spectral: the integrand is periodic.
  double sum = 0, difference = 0;
  for (int k = 0; k < n; ++k) {
    const double versine = 2 * std::pow(std::sin(M_PI * (k + 0.5) / n), 2);
    const double value = std::exp(-x * versine);
    sum += value;
    difference += 0.5 * versine * value;
  }
  return {sum / n, difference / n};
}

struct Normalizer {
  double log_f = 0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

/// log F and its gradient, for λ in any order.
inline Normalizer normalizer(const Eigen::Vector4d& lambda) {
  std::array<int, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return lambda[i] > lambda[j]; });
  const double top = lambda[order[0]];
  const double a = 0.5 * (top - lambda[order[1]]);
  const double b = top - lambda[order[2]];
  const double c = 0.5 * (lambda[order[2]] - lambda[order[3]]);
  const double h = 1.0 / 48;
  double f = 0;
  Eigen::Vector4d g = Eigen::Vector4d::Zero();
  for (int k = -static_cast<int>(5.0 / h); k <= static_cast<int>(5.0 / h); ++k) {
    const double t = k * h;
    const double e = std::exp(M_PI * std::sinh(t));
    const double u = e / (1 + e), rest = 1 / (1 + e);
    const double weight = h * M_PI * std::cosh(t) * u * rest * std::exp(-u * b);
    if (!(weight > 0)) continue;
    const auto [i0_mode, half_mode] = scaled_bessel(rest * a);
    const auto [i0_other, half_other] = scaled_bessel(u * c);
    f += weight * i0_mode * i0_other;
    g[order[0]] += weight * rest * (i0_mode - half_mode) * i0_other;
    g[order[1]] += weight * rest * half_mode * i0_other;
    g[order[2]] += weight * u * i0_mode * (i0_other - half_other);
    g[order[3]] += weight * u * i0_mode * half_other;
  }
  return {std::log(2 * M_PI * M_PI * f) + top, g / f};
}

}  // namespace bpa::oracle
