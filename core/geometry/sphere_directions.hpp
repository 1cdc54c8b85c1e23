// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

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

/// The farthest point along each of `directions` sphere_direction()s; none for no points.
inline std::vector<Eigen::Vector3f> outermost(const std::vector<Eigen::Vector3f>& points,
                                              int directions) {
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < directions && !points.empty(); ++i) {
    const Eigen::Vector3f direction = sphere_direction(i, directions).cast<float>();
    out.push_back(
        *std::ranges::max_element(points, {}, [&](const auto& p) { return p.dot(direction); }));
  }
  return out;
}

/// The largest distance of two of the points: exact over those that are outermost().
inline double largest_distance(const std::vector<Eigen::Vector3f>& points, int directions = 200) {
  const std::vector<Eigen::Vector3f> outer = outermost(points, directions);
  float squared = 0;
  for (const Eigen::Vector3f& a : outer) {
    for (const Eigen::Vector3f& b : outer) squared = std::max(squared, (a - b).squaredNorm());
  }
  return std::sqrt(squared);
}

}  // namespace bpa
