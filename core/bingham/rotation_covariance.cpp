// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/bingham/bingham.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Gauss and Legendre's sixteen points, the positive half.
static constexpr double kPoints[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274,
                                      0.6178762444026438, 0.7554044083550030, 0.8656312023878318,
                                      0.9445750230732326, 0.9894009349916499};
static constexpr double kWeights[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025,
                                       0.1495959888165767, 0.1246289712555339, 0.0951585116824928,
                                       0.0622535239386479, 0.0271524594117541};

Matrix3d rotation_covariance(const Bingham& bingham) {
  constexpr double kEnd = 0.5 * M_PI;
  const Vector3d lambda = bingham.concentrations().tail<3>();
  const double log_f = bingham.log_normalizer();
  Vector3d variance = Vector3d::Zero();
  const auto add = [&](double phi, double weight) {
    const double s2 = std::sin(phi) * std::sin(phi);
    const double density = std::exp(bingham_log_normalizer_s2(s2 * lambda) - log_f);
    variance += (weight * 2 * s2 * density * 4 * phi * phi) * bingham_gradient_s2(s2 * lambda);
  };
  // Over half the angle, in pieces that double in length from the scale of the largest
  // concentration.
  double from = 0, to = std::min(kEnd, 1 / std::sqrt(1 - lambda[2]));
  while (from < kEnd) {
    const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
    for (int i = 0; i < 8; ++i) {
      add(middle - half * kPoints[i], half * kWeights[i]);
      add(middle + half * kPoints[i], half * kWeights[i]);
    }
    const double s = std::sin(to);
    if (-lambda[0] * s * s > 80) break;  // The rest is below 1e-34.
    from = to;
    to = std::min(kEnd, 2 * to);
  }
  // v ∘ mode⁻¹ is a pure quaternion: the fixed axis of a deviation along v.
  const Eigen::Matrix4d turned = bingham.rotated_right(bingham.mode().conjugate()).axes();
  const Matrix3d axes = turned.bottomRightCorner<3, 3>();
  return axes * variance.asDiagonal() * axes.transpose();
}

}  // namespace bpa
