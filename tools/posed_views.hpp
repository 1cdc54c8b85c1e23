// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/modeling/turntable.hpp"
#include "tools/command.hpp"

// The views that models are made of: of data sets, and of the simulator. Making models is
// core/modeling's work, which knows neither.

namespace bpa::cli {

/// Reads a split of a BOP data set as a turntable scan and finds the poses of its views. A scene is
/// a resting position; image numbers count the table's steps. Truth and masks are not read.
modeling::AlignedScan align_scan_of(const std::string& dataset, const std::string& split,
                                    double step_deg, const CommonOptions& common);

/// The views of a BOP split that show object `obj_id`, with the poses of scene_gt.json; where there
/// is mask_visib, only its pixels belong to the object.
std::vector<modeling::PosedView> read_posed_views(const std::string& dataset,
                                                  const std::string& split, int obj_id,
                                                  int num_threads);

/// What a Kinect-class camera measures of a mesh from `count` directions over the sphere. The mesh
/// is in the middle of an empty room, at 0.8 m, more for large objects. `title` is a progress
/// bar's. The same input and seed give the same views for any number of threads.
std::vector<modeling::PosedView> simulate_views(const TriangleMesh& mesh, int count,
                                                std::uint64_t seed, int num_threads,
                                                const std::string& title);

constexpr int kSimulatedViews = 120;  ///< Of a mesh that becomes a model, unless told otherwise.

/// Leaves of a model what simulate_views() measures of its mesh, and learns what that is off by.
/// With a count of 0 the model stays as it is.
void look_at(const TriangleMesh& mesh, int count, const CommonOptions& common, ModelSource& source);

/// A surface of squares, one for each oriented point, large enough to leave no hole between
/// neighbours: what a camera can look at in place of a point cloud.
TriangleMesh squares_of(const PointCloud& cloud);

}  // namespace bpa::cli
