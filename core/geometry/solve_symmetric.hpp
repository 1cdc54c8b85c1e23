// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace bpa {

using UpTo7x7 = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7>;
using UpTo7 = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 7, 1>;

// Eigen's LDLT, compiled once: a file that calls it takes 3 s longer to compile.

/// x of a x = b; `a` is N x N (N <= 7), symmetric and positive definite.
UpTo7 solve_symmetric(const UpTo7x7& a, const UpTo7& b);

/// a⁻¹; `a` as above.
UpTo7x7 inverse_symmetric(const UpTo7x7& a);

}  // namespace bpa
