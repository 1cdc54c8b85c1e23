// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/point_cloud.hpp"
#include "core/model/occupancy_grid.hpp"
#include "core/modeling/posed_view.hpp"

namespace bpa::modeling {

/// Traces the ray of every pixel of the views through the grid. The measured point lies in one
/// cell. Cells before it are empty on the side that faces the camera, except within the sensor's
/// noise. Rays of pixels outside the object end in no cell, but empty the cells they pass. The same
/// for any number of threads.
OccupancyGrid trace_occupancy(const std::vector<PosedView>& views, float cell, int num_threads);

/// The surface of what is occupied (probability 0.5 or more) and seen from outside: bucket means,
/// drawn together along their normals to one sheet for each side of a wall, `spacing` apart. With
/// the normal variance of each point: the mean squared angle of measured normals from its own.
struct GridSurface {
  PointCloud points;
  std::vector<float> normal_variance;
};
GridSurface surface_of(const OccupancyGrid& grid, float spacing, int num_threads);

}  // namespace bpa::modeling
