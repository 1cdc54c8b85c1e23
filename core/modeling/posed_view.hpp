// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/geometry/pose.hpp"
#include "core/modeling/model_source.hpp"

namespace bpa::modeling {

/// One view of an object from a known place: real or simulated.
struct PosedView {
  SurfaceMap map;                                   ///< As the detector would see it.
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< For each pixel of the map; may be empty.
  std::vector<std::uint8_t> object;                 ///< 1 where the pixel may belong to the object.
  Pose camera_from_object;
  int id = 0;  ///< The caller's number of the view.
};

/// Halves the frame as the detector does and takes its normals. `object` is a mask over the frame's
/// pixels (1 = object), or empty: then every pixel may belong to it. `sensor` as
/// SurfaceMapOptions::sensor.
PosedView make_posed_view(const Frame& frame, const std::vector<std::uint8_t>& object,
                          const Pose& camera_from_object, const std::string& sensor = "auto");

/// One bin of errors that were observed at nearly the same edge distance and surface angle.
struct NoiseBin {
  double edge_distance = 0;
  double angle = 0;
  double sigma = 0;  ///< Root mean square of the errors.
  double count = 0;
};

/// What views say about each point of a surface.
struct SurfaceObservations {
  std::vector<int> seen;               ///< Views in which the point was measured.
  std::vector<float> normal_variance;  ///< Mean squared angle between its normal and those
                                       ///< measured, radians squared; 0 where it was never seen.
  /// Mean colours; empty when the views have none. Black where the point was never seen well.
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<NoiseBin> range_bins;   ///< Errors of range, metres, by edge distance and angle.
  std::vector<NoiseBin> normal_bins;  ///< Errors of normals, radians.
  double depth = 0;                   ///< Mean depth of what was measured, metres.
};

/// Compares a surface with the views' measurements of it (paper section III): at points that should
/// be visible, within 2 cm. The same for any number of threads.
SurfaceObservations observe_surface(const PointCloud& surface, const std::vector<PosedView>& views,
                                    int num_threads);

/// The curve under which the bins are most likely: weighted least squares on log(sigma), whose
/// variance is 1 / (2 count), by Levenberg-Marquardt from `start`. Bins of less than 30 errors do
/// not count. Returns `start` when fewer than 7 bins are left.
NoiseCurve fit_noise_curve(std::span<const NoiseBin> bins, const NoiseCurve& start);

/// Fills a model's noise curves from views of it, and colours and normal variances where it has
/// none; warns when part of it was never measured.
void learn_noise(ModelSource& source, const std::vector<PosedView>& views, int num_threads);

/// Reduces a model of exactly known surface to what a sensor can see. Traces the views through the
/// occupancy grid and drops points where the grid is not occupied on their side. Takes the normal
/// variances from the grid and learns the noise. Points stay in place, nearer to the truth than
/// means of measurements. Warns when much drops out. A surface that no view shows stays whole, with
/// another warning.
void keep_measured(ModelSource& source, const std::vector<PosedView>& views, int num_threads);

/// A model of what the views show: traced, thresholded and thinned (occupancy_grid.hpp), in their
/// poses' frame. Fails with invalid_argument on under 100 surface points or an impossible size.
Result<ModelSource> model_source_from_views(std::vector<PosedView> views, const std::string& name,
                                            int number, const ModelOptions& options = {});

/// Moves the origin of the object's frame to the middle of the box about what the views measured.
void center_object(std::vector<PosedView>& views);

}  // namespace bpa::modeling
