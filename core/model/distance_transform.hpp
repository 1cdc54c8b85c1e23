// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/shared_array.hpp"

namespace bpa {

/// The nearest model point to each cell of a grid round the model (paper section III): one lookup
/// instead of a search.
struct DistanceTransform {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();  ///< Corner of cell (0, 0, 0), metres.
  float cell = 1;                                 ///< Side of a cell, metres.
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  SharedArray<std::uint32_t> nearest;  ///< Point nearest to each cell's centre; x fastest.

  /// The cell of a point, -1 outside the grid.
  std::int64_t cell_of(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f scaled = (point - low) / cell;
    if (!(scaled.array() >= 0).all()) return -1;  // NaN too
    const Eigen::Vector3i c = scaled.cast<int>();
    if ((c.array() >= size.array()).any()) return -1;
    return (static_cast<std::int64_t>(c.z()) * size.y() + c.y()) * size.x() + c.x();
  }
  /// The model point that is nearest to the centre of the point's cell, -1 outside the grid: no
  /// model point is nearer to `point` by more than a cell's diagonal.
  int nearest_to(const Eigen::Vector3f& point) const {
    const std::int64_t c = cell_of(point);
    return c < 0 ? -1 : static_cast<int>(nearest[c]);
  }
};

/// The transform of some points (at least one), out to `margin` metres round their bounding box.
/// Cells of `cell` metres, larger where they would be more than `max_cells`. Which point is nearest
/// is exact to a cell.
DistanceTransform distance_transform(std::span<const Eigen::Vector3f> points, float cell,
                                     float margin, int max_cells = 400000);

/// For every cell of a grid (x fastest; one layer is an image), the nearest cell that is marked, by
/// the distance of the centres; -1 everywhere when none is. Exact, in time proportional to the
/// cells (Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions", 2012).
std::vector<std::int32_t> nearest_marked_cells(const std::vector<std::uint8_t>& marked,
                                               const Eigen::Vector3i& size);

}  // namespace bpa
