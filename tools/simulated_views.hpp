// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/modeling/posed_view.hpp"

namespace bpa::cli {

/// What a Kinect-class camera measures of a mesh from `count` directions spread over the sphere, in
/// the middle of an empty room. The distance suits the object: 0.8 m, more for large ones. `title`
/// is that of a progress bar. The same input and seed give the same views for any number of
/// threads.
std::vector<PosedView> simulate_views(const TriangleMesh& mesh, int count, std::uint64_t seed,
                                      int num_threads, const std::string& title);

/// A surface of squares, one for each oriented point, large enough to leave no hole between
/// neighbours: what a camera can look at in place of a point cloud.
TriangleMesh squares_of(const PointCloud& cloud);

}  // namespace bpa::cli
