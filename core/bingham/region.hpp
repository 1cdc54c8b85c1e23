// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/bingham/bingham.hpp"

// How sure a Bingham is, in terms a user can act on. Everything here is exact (to about 1e-6) for
// any concentrations, uniform ones included; nothing assumes a Gaussian. README.md derives it.

namespace bpa {

/// The probability that the energy -log(p(q) / p(mode)) is at most `energy`.
double credible_mass(const Bingham& bingham, double energy);

/// The energy such that {q : energy(q) ≤ it}, the highest density region, has `probability` in
/// [0, 1).
double credible_energy(const Bingham& bingham, double probability);

/// The probability that the rotation from the mode is by at most `angle` radians, in [0, π].
double angle_mass(const Bingham& bingham, double angle);

/// The angle in radians that the rotation from the mode exceeds with probability 1 - `probability`
/// only.
double angle_bound(const Bingham& bingham, double probability);

/// E[ω ωᵀ] of the rotation vector ω, q = exp(ω) ∘ mode, angle in [0, π], rad². The axes are those
/// of the frame that q maps into: the 3x3 block of a ROS covariance.
Eigen::Matrix3d rotation_covariance(const Bingham& bingham);

}  // namespace bpa
