// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// Finds all points within a fixed radius: points sorted by the cubic cell of that size they lie
/// in, cells found by binary search over 64-bit keys. Keeps a copy of the points.
class NeighborGrid {
 public:
  /// `radius` > 0, metres.
  NeighborGrid(std::span<const Eigen::Vector3f> points, float radius);

  /// Calls visit(index, squared_distance) for every point within the radius of `query`, in an order
  /// that depends on the points alone.
  void for_each_neighbor(const Eigen::Vector3f& query, const auto& visit) const {
    const Eigen::Vector3i cell = cell_of(query);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        // The three cells along x have consecutive keys.
        const auto [first, last] = row(cell.x() - 1, cell.y() + dy, cell.z() + dz);
        for (auto i = first; i < last; ++i) {
          const float squared = (points_[i] - query).squaredNorm();
          if (squared <= radius_squared_) visit(static_cast<int>(order_[i]), squared);
        }
      }
    }
  }

 private:
  Eigen::Vector3i cell_of(const Eigen::Vector3f& point) const;
  std::pair<std::ptrdiff_t, std::ptrdiff_t> row(int x, int y, int z) const;

  float inverse_cell_ = 1;
  float radius_squared_ = 0;
  std::vector<std::uint64_t> keys_;  // sorted
  std::vector<std::uint32_t> order_;
  std::vector<Eigen::Vector3f> points_;  // in the order of keys_
};

/// One point for each occupied cube of side `spacing`: the means of points, normals (normalised)
/// and colours. Points without a normal (a zero one) are left out when the cloud has normals;
/// opposite sides of a thin wall are kept apart (normals that differ by more than 90 degrees are
/// averaged separately). Deterministic.
PointCloud downsample(const PointCloud& cloud, float spacing);

}  // namespace bpa
