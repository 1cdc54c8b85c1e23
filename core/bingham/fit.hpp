// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/bingham/bingham.hpp"

namespace bpa {

/// The Bingham whose scatter E[q qᵀ] is the given one, of trace 1: the maximum likelihood fit to
/// samples with that mean of q qᵀ. Newton's method on log F(λ) - λ · τ, which is convex.
/// Eigenvalues τ of the scatter below 1e-12, as of fewer than four samples, count as 1e-12.
Bingham fit_bingham(const Eigen::Matrix4d& scatter);

/// The maximum likelihood fit to unit quaternions (signs do not matter), optionally weighted.
/// Uniform for none. `weights` is empty or as long as `samples`, not negative, any positive sum.
Bingham fit_bingham(std::span<const Eigen::Quaterniond> samples,
                    std::span<const double> weights = {});

}  // namespace bpa
