// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/cloud/frame.hpp"
#include "core/sim/sensor.hpp"

// Figures that compare a simulated depth camera with published ones and with real frames.

namespace bpa::sim {

/// How the simulated camera measures a plane.
struct PlaneNoise {
  double axial = 0;    ///< Standard deviation of depth, metres.
  double lateral = 0;  ///< Standard deviation of where a vertical edge of it is, pixels.
  double missing = 0;  ///< Share of its pixels without depth.
};

/// Measures a wide plane, `depth` metres away in the middle. Its normal is turned by `angle`
/// radians (up to 80 degrees) about the image's vertical axis. Depth as measured, before
/// registration.
PlaneNoise plane_noise(double depth, double angle, const SensorOptions& options,
                       std::uint64_t seed = 1, int num_threads = 0);

/// What an image of any scene tells about its camera. Pixels are those of a Kinect's infrared
/// camera (focal length 570.3), for any focal length of the frame. Disparity is to a projector 7.5
/// cm beside it.
struct DepthStatistics {
  double missing = 0;      ///< Share of pixels without depth, but for an unmeasured margin.
  double small_holes = 0;  ///< Holes of at most 20 square pixels for each 10000 pixels.
  double left_gap = 0;     ///< Mean pixels without depth left of what stands out.
  double right_gap = 0;    ///< And right of it.
  double roughness = 0;    ///< Median over patches of the rms residual about a plane, disparity px.
  double near_correlation = 0;  ///< Of those residuals, of points 1.5 pixels apart ...
  double far_correlation = 0;   ///< ... and of points 5 pixels apart.
};

/// Zeros for a frame without depth.
DepthStatistics depth_statistics(const Frame& frame);

}  // namespace bpa::sim
