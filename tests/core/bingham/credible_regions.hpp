// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/bingham/bingham.hpp"
#include "core/bingham/normalizer.hpp"

// How sure a Bingham is, by which tests judge it. Exact (to about 1e-6) for any concentrations,
// uniform ones included. With A = |λ1| sin²α ≤ B = |λ2| cos²β + |λ3| sin²β,
//
//   P(energy ≤ c) = (8/F) ∫∫_[0,π/2]² max(0, e^-A - e^-min(B,c)) / (B - A) dα dβ,
//   P(angle ≤ θ) = (2/F) ∫₀^(θ/2) sin²φ F2(sin²φ (λ1, λ2, λ3)) dφ,   F2 the normaliser on S2.

namespace bpa {

/// -E[log p], nats.
inline double entropy(const Bingham& bingham) {
  const BinghamNormalizer normalizer = bingham_normalizer(bingham.concentrations());
  return normalizer.log_f - bingham.concentrations().dot(normalizer.gradient);
}

/// Kullback-Leibler divergence of `approximation` from `truth`, E_truth[log truth - log approx].
inline double kl_divergence(const Bingham& truth, const Bingham& approximation) {
  return approximation.log_normalizer() - entropy(truth) -
         approximation.exponent().cwiseProduct(truth.scatter()).sum();
}

// Gauss and Legendre's sixteen points, the positive half.
inline constexpr double kPoints[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274,
                                      0.6178762444026438, 0.7554044083550030, 0.8656312023878318,
                                      0.9445750230732326, 0.9894009349916499};
inline constexpr double kWeights[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025,
                                       0.1495959888165767, 0.1246289712555339, 0.0951585116824928,
                                       0.0622535239386479, 0.0271524594117541};

inline double integrate(double from, double to, int pieces, const auto& f) {
  const double half = 0.5 * (to - from) / pieces;
  double sum = 0;
  for (int piece = 0; piece < pieces; ++piece) {
    const double middle = from + (2 * piece + 1) * half;
    for (int i = 0; i < 8; ++i) {
      sum += kWeights[i] * (f(middle - half * kPoints[i]) + f(middle + half * kPoints[i]));
    }
  }
  return sum * half;
}

// Where the increasing function f reaches `target`, between lower and upper (false position with
// the Illinois rule, bisecting when that is slow).
inline double solve_increasing(double lower, double upper, double target, const auto& f) {
  double f_lower = f(lower) - target, f_upper = f(upper) - target;
  if (f_lower >= 0) return lower;
  if (f_upper <= 0) return upper;
  for (int i = 0; i < 200 && upper - lower > 1e-12 * upper; ++i) {
    double middle = (lower * f_upper - upper * f_lower) / (f_upper - f_lower);
    if (i % 3 == 2 || !(middle > lower && middle < upper)) middle = 0.5 * (lower + upper);
    const double value = f(middle) - target;
    if (std::abs(value) < 1e-13) return middle;
    if (value < 0) {
      lower = middle;
      f_lower = value;
      f_upper *= 0.5;
    } else {
      upper = middle;
      f_upper = value;
      f_lower *= 0.5;
    }
  }
  return 0.5 * (lower + upper);
}

// With q = (√(1-u) cos α, √(1-u) sin α, √u cos β, √u sin β) in the axes, the energy is
// (1-u) A + u B, A = a sin²α and B = b cos²β + c sin²β, and u and the angles are uniform. The
// integral over u is elementary, and where B exceeds the bound, that over β is too.
struct CredibleIntegral {
  double a, b, c;  // 0 ≤ a ≤ b ≤ c: the concentrations' magnitudes.
  double bound;    // Energy.

  // ∫ over β in [0, π/2] of (e^-A - e^-min(B, bound)) / (B - A).
  double over_beta(double big_a) const {
    const double at_a = std::exp(-big_a);
    const double p = std::max(0.0, b - big_a), q = c - big_a;
    double inner = 0, cosine = 1, sine = 0;
    if (bound > b) {
      sine = bound < c ? std::sqrt((bound - b) / (c - b)) : 1;
      cosine = bound < c ? std::sqrt((c - bound) / (c - b)) : 0;
      const double edge = std::atan2(sine, cosine);
      inner = integrate(0, edge, 2, [&](double beta) {
        const double s = std::sin(beta);
        const double difference = p + (c - b) * s * s;
        return difference < 1e-8 ? at_a * (1 - 0.5 * difference)
                                 : -at_a * std::expm1(-difference) / difference;
      });
      if (bound >= c) return inner;
    }
    const double root_p = std::sqrt(p), root_q = std::sqrt(q);
    const double y = root_p * cosine, x = root_q * sine;
    const double angle_over_root_p =
        root_p > 1e-7 * root_q || x == 0 ? std::atan2(y, x) / root_p : cosine / x;
    return inner - at_a * std::expm1(big_a - bound) * angle_over_root_p / root_q;
  }

  double value() const {
    const double edge = bound < a ? std::asin(std::sqrt(bound / a)) : 0.5 * M_PI;
    return integrate(0, edge, 3, [&](double alpha) {
      const double s = std::sin(alpha);
      return over_beta(a * s * s);
    });
  }
};

/// The probability that the energy -log(p(q) / p(mode)) is at most `energy`.
inline double credible_mass(const Bingham& bingham, double energy) {
  const Eigen::Vector4d magnitude = -bingham.concentrations();
  if (!(energy > 0)) return 0;
  if (energy >= magnitude[3] || energy > 700) return 1;
  const CredibleIntegral integral{magnitude[1], magnitude[2], magnitude[3], energy};
  return std::min(1.0, 8 * integral.value() * std::exp(-bingham.log_normalizer()));
}

/// The energy such that {q : energy(q) ≤ it}, the highest density region, has `probability` in
/// [0, 1).
inline double credible_energy(const Bingham& bingham, double probability) {
  const double largest = std::min(-bingham.concentrations()[3], 700.0);
  // Like half a chi-square of three degrees of freedom, or less.
  double upper = std::min(largest, 8.0);
  while (upper < largest && credible_mass(bingham, upper) < probability) upper *= 2;
  return solve_increasing(0, std::min(upper, largest), probability,
                          [&](double energy) { return credible_mass(bingham, energy); });
}

/// The probability that the rotation from the mode is by at most `angle` radians, in [0, π].
inline double angle_mass(const Bingham& bingham, double angle) {
  const Eigen::Vector3d lambda = bingham.concentrations().tail<3>();
  const double log_f = bingham.log_normalizer();
  double sum = 0;
  const double end = 0.5 * std::clamp(angle, 0.0, M_PI);
  // Pieces double in length from the scale of the largest concentration.
  double from = 0, to = std::min(end, 1 / std::sqrt(1 - lambda[2]));
  while (from < end) {
    sum += integrate(from, to, 1, [&](double phi) {
      const double s2 = std::sin(phi) * std::sin(phi);
      return s2 * std::exp(bingham_log_normalizer_s2(s2 * lambda) - log_f);
    });
    from = to;
    to = std::min(end, 2 * to);
  }
  return std::min(1.0, 2 * sum);
}

/// The angle in radians that the rotation from the mode exceeds with probability 1 - `probability`
/// only.
inline double angle_bound(const Bingham& bingham, double probability) {
  return solve_increasing(0, M_PI, probability,
                          [&](double angle) { return angle_mass(bingham, angle); });
}

}  // namespace bpa
