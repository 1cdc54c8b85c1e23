// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace bpa {

/// The `index`-th of `count` unit vectors spread evenly over the sphere, from +z to -z: a Fibonacci
/// lattice (Gonzalez, "Measurement of areas on a sphere using Fibonacci and latitude-longitude
/// lattices", Mathematical Geosciences 42, 2010).
inline Eigen::Vector3d sphere_direction(int index, int count) {
  const double golden_angle = M_PI * (3 - std::sqrt(5.0));
  const double z = 1 - (2 * index + 1.0) / count;
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(golden_angle * index), r * std::sin(golden_angle * index), z};
}

}  // namespace bpa
