// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/solve_symmetric.hpp"

#include <Eigen/Cholesky>

namespace bpa {

UpTo7 solve_symmetric(const UpTo7x7& a, const UpTo7& b) { return a.ldlt().solve(b); }

UpTo7x7 inverse_symmetric(const UpTo7x7& a) {
  return a.ldlt().solve(UpTo7x7::Identity(a.rows(), a.cols()));
}

}  // namespace bpa
