// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace bpa {

// The normalising constant of the Bingham distribution on S3, for any finite λ:
//
//   F(λ) = ∫_{S3} exp(Σ λi xi²) dx,   F(0) = 2π².
//
// One rule of fourteen complex nodes serves all λ. F is the inverse Laplace transform, at 1, of 2π²
// Π (z - λi)^(-1/2): integrate a Gaussian over R4 by spheres. Its branch points lie on the real
// axis. On Talbot's contour around them (Weideman and Trefethen 2007) the midpoint rule converges
// as 3.9^-n. The relative error is below 1e-11 for every λ. Derivatives come from the same nodes.
// README.md derives it.

/// log F(λ).
double bingham_log_normalizer(const Eigen::Vector4d& lambda);

struct BinghamNormalizer {
  double log_f = 0;          ///< log F(λ).
  Eigen::Vector4d gradient;  ///< ∂ log F / ∂λi = E[xi²], the scatter on the axes; sums to 1.
  Eigen::Matrix4d fourth;    ///< E[xi² xj²] = (1/F) ∂²F / ∂λi ∂λj.
};

/// log F with its first and second derivatives.
BinghamNormalizer bingham_normalizer(const Eigen::Vector4d& lambda);

/// log of ∫_{S2} exp(Σ λi xi²) dx, the same on the sphere in R3 (4π for zero).
double bingham_log_normalizer_s2(const Eigen::Vector3d& lambda);
/// Its gradient E[xi²].
Eigen::Vector3d bingham_gradient_s2(const Eigen::Vector3d& lambda);

}  // namespace bpa
