// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace bpa {

/// Where a lens shows the point (x, y) of the normalised image plane. `coefficients` are k1 k2 p1
/// p2 k3 k4 k5 k6 of OpenCV's and ROS's plumb_bob and rational_polynomial; those that are left out
/// are 0, more than 8 are ignored.
inline Eigen::Vector2d distort(const std::vector<double>& coefficients, double x, double y) {
  double k[8] = {};
  std::copy_n(coefficients.begin(), std::min<std::size_t>(8, coefficients.size()), k);
  const double r2 = x * x + y * y;
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
          y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
}

}  // namespace bpa
