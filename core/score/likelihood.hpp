// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/tolerance.hpp"

// The pieces that score components are made of.

namespace bpa::score {

/// The value of a score component that is not known.
constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

/// The log-likelihood of an error under a normal distribution, relative to that of no error.
/// Truncated at three standard deviations, so as not to over-penalise outliers, and scaled to [-1,
/// 0] (paper V.5).
inline double truncated_log_normal(double error, double sigma) {
  const double z = error / (3 * sigma);
  return -std::min(z * z, 1.0);
}

/// log(probability), cut off at log(floor) and scaled to [-1, 0].
inline double truncated_log(double probability, double floor) {
  return -std::min(std::log(std::max(probability, floor)) / std::log(floor), 1.0);
}

/// The probability that a model point is visible (paper V.5, footnote), by the observed depth less
/// the predicted one. 1 in front of the observed surface, else falling with sigma_vis = 1 cm. `exp`
/// is std::exp or as good.
template <class Real>
inline Real visibility_by_difference(Real difference, auto exp) {
  constexpr auto kSigma = static_cast<Real>(tolerance::kVisibilitySigma);
  const Real z = (difference < 0 ? difference : 0) / kSigma;
  return exp(static_cast<Real>(-0.5) * z * z);
}

/// The same; 1 without an observed depth.
inline double visibility_probability(double observed_depth, double predicted_depth) {
  if (!(observed_depth > 0)) return 1;
  return visibility_by_difference(observed_depth - predicted_depth,
                                  [](double x) { return std::exp(x); });
}

}  // namespace bpa::score
