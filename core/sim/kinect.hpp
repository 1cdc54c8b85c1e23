// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/frame.hpp"
#include "core/sim/sensor_view.hpp"

// A depth camera with a projected dot pattern (Kinect v1, Xtion, PrimeSense), simulated in steps:
//
//  1. Triangulation. A projector 7.5 cm to the infrared camera's right lights the scene. What it
//     does not reach has no depth: shadows left of everything that stands out.
//  2. Matching (Khoshelham and Elberink 2012, "Accuracy and resolution of Kinect depth data",
//     Sensors 12). A 9 x 9 window is looked up in the stored pattern. It needs enough lit pixels of
//     one disparity, so depth ends before an edge does. Edges are ragged by about 0.8 pixels
//     (lateral noise of Nguyen, Izadi and Lovell 2012, "Modeling Kinect sensor noise", 3DIMPVT).
//     Since windows overlap, edges are waves a few pixels long. Single pixels without a match are
//     filled.
//  3. Signal. Its strength falls with z^1.5 and the square root of the cosine of incidence. That is
//     between the law of light and a gain control. Matching fails where little light returns: dark,
//     far or grazing surfaces. Mirror-like surfaces that reflect the projector straight back fail
//     too. Source: Mallick, Das and Majumdar 2014, "Characterizations of noise in Kinect depth
//     images", IEEE Sensors J. 14.
//  4. Noise. Depth gets the axial noise of Nguyen et al. through noise of disparity. It is 0.0012 +
//     0.0019 (z - 0.4)^2 m. Beyond 60 degrees of incidence it gains 0.0001 / sqrt(z) * angle^2 /
//     (pi/2 - angle)^2 m. Windows overlap: neighbours share most of it. A badly calibrated sensor
//     adds an error that changes slowly over the image. Source: Herrera, Kannala and Heikkilä 2012,
//     "Joint depth and color camera calibration with distortion correction", IEEE T-PAMI 34.
//  5. Quantisation. Disparity comes in steps of 1/8 pixel (Khoshelham and Elberink): 2.9 mm of
//     depth at 1 m, growing with z^2. Depth is in millimetres.
//  6. Registration. Depth is carried over to the colour camera, 2.5 cm beside the infrared one.
//
// The widths of waves, gaps and holes were compared with real frames: bpa-experiments sensor.

namespace bpa::sim {

/// Every effect can be turned down to none.
struct KinectOptions {
  BPA_OPTION(double, baseline, 0.075, (0, 0.5), "Infrared camera to projector, metres.");
  BPA_OPTION(double, disparity_step, 0.125, (0, 4), "Steps of disparity, pixels; 0 = none.");
  BPA_OPTION(double, infrared_focal, 570.3, (200, 4000),
             "Focal length of the 640x480 infrared image, pixels.");
  BPA_OPTION(double, axial_noise, 1, (0, 10), "Times the published noise along the axis.");
  BPA_OPTION(double, calibration_error, 0, (0, 2),
             "Standard deviation of the smooth error of disparity, pixels; 0.4 is 1 cm at 1 m.");
  BPA_OPTION(double, lateral_noise, 1, (0, 10), "Times the published noise of edges.");
  BPA_OPTION(double, edge_gaps, 1, (0, 2), "Times the usual share of a window that must agree.");
  BPA_OPTION(double, dropouts, 1, (0, 10), "Times the usual chance that a pixel has no depth.");
  BPA_OPTION(bool, shadows, true, (0, 1), "No depth where the projector does not reach.");
  BPA_OPTION(bool, registered, true, (0, 1),
             "Measure from beside the colour camera and carry over.");
  BPA_OPTION(double, color_baseline, 0.025, (0, 0.5), "Infrared to colour camera, metres.");
  BPA_OPTION(double, min_range, 0.4, (0, 20), "Nearest depth measured, metres.");
  BPA_OPTION(double, max_range, 4.5, (0, 20), "Farthest depth measured, metres.");
};

/// The axial standard deviation of depth that the model must meet, metres (step 4). For a surface
/// at `depth` metres seen at `angle` radians from its normal.
double published_axial_noise(double depth, double angle);

/// Depth alone, in a fraction of simulate_sensor()'s time. Another `shot` (from 0) of one seed is
/// the same camera a moment later: it has other noise. The same options and seed give the same
/// image for any number of threads.
Frame simulate_depth(const SensorView& view, const KinectOptions& options, std::uint64_t seed,
                     int shot = 0, int num_threads = 0);

}  // namespace bpa::sim
