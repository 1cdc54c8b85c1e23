// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace bpa {

/// What the views from one side say of a grid cell.
struct ViewBucket {
  float occupancy = 0;  ///< Share of the rays from this side that end in the cell, of those that
                        ///< reach it: the probability that something is there.
  int rays = 0;         ///< That ended in the cell.
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< Mean of where they did, metres.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    ///< Mean of what they measured, unit length.
  float normal_variance = 0;  ///< Mean squared angle from that mean, radians squared.
};

/// Whether a bucket is part of the surface: occupancy of at least 0.5 from at least 3 rays.
inline bool occupied(const ViewBucket& bucket) {
  constexpr int kFewestRays = 3;
  return bucket.rays >= kFewestRays && bucket.occupancy >= 0.5f;
}

/// A cell with two view-buckets: a wall thinner than a cell has two surfaces in it (paper section
/// III, footnote).
struct OccupancyCell {
  Eigen::Vector3i place;  ///< In the grid.
  std::array<ViewBucket, 2> buckets;
};

/// The cells in which some ray ended.
struct OccupancyGrid {
  Eigen::Vector3f low =
      Eigen::Vector3f::Zero();  ///< Corner of cell (0, 0, 0), object frame, metres.
  float cell = 1;               ///< Side of a cell, metres.
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  std::vector<OccupancyCell> cells;
};

}  // namespace bpa
