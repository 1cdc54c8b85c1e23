// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/frame.hpp"
#include "core/sim/sensor_view.hpp"

// Two infrared cameras and a projector of dots between them (Intel RealSense D400), simulated in
// steps:
//
//  1. Visibility. The left camera's image is matched along its rows with the right camera's. What
//     the right one does not see has no depth: it fails the check from right to left. That is left
//     of everything that stands out. Source: Keselman, Woodfill, Grunnet-Jepsen and Bhowmik 2017,
//     "Intel RealSense stereoscopic depth cameras", CVPR workshops.
//  2. Texture. Matching needs contrast: of the projected dots, which fade with z^1.5 and the root
//     of the cosine of incidence (as a Kinect's), or of the surface itself. It fails on surfaces
//     that are dark, far or grazing without a texture, and where they mirror the projector.
//  3. Window. A window's disparity is that of its nearest surface, once this fills a quarter of it.
//     So silhouettes are fattened by up to half a window, and are ragged. Source: Hirschmüller,
//     Innocent and Garibaldi 2002, "Real-time correlation-based stereo vision with reduced border
//     errors", IJCV 47. The window is 9 x 9 pixels. A small enough step (under a pixel of
//     disparity) becomes a slope as wide as the window: disparities of one window are averaged.
//  4. Noise of disparity: 0.08 pixels, which neighbours within a window share. The noise of depth
//     is z^2 * 0.08 / (focal length * baseline). Source: Grunnet-Jepsen, Sweetser and Woodfill
//     2018, "Best-known-methods for tuning Intel RealSense D400 depth cameras", Intel. Ahn et al.
//     2019, "Analysis and noise modeling of the Intel RealSense D435 for mobile robots", UR, have
//     0.0011 + 0.0007 z + 0.0039 z^2 m for a D435. Weak contrast makes it up to twice as large.
//  5. Quantisation: steps of 1/32 pixel. Source: Grunnet-Jepsen et al. 2018, "Subpixel linearity
//     improvement for Intel RealSense depth cameras", Intel. Depth is in millimetres.
//  6. Registration to the colour camera, 1.5 cm to the left of the left infrared camera.
//
// The defaults are a D415's: 1280 x 720 pixels over 69 degrees, baseline 55 mm, depth from 0.45 m
// on (Intel RealSense D400 series datasheet). A D435 has 848 x 480 pixels, focal length 425,
// baseline 50 mm.

namespace bpa::sim {

/// Every effect can be turned down to none.
struct ActiveStereoOptions {
  BPA_OPTION(double, baseline, 0.055, (0.001, 0.5), "Left to right infrared camera, metres.");
  BPA_OPTION(int, width, 1280, (64, 4096), "Of the infrared images, pixels.");
  BPA_OPTION(int, height, 720, (64, 4096), "Of the infrared images, pixels.");
  BPA_OPTION(double, infrared_focal, 924, (50, 4000), "Of the infrared images, pixels.");
  BPA_OPTION(double, disparity_noise, 0.08, (0, 2), "Standard deviation, pixels.");
  BPA_OPTION(double, disparity_step, 0.03125, (0, 4), "Steps of disparity, pixels; 0 = none.");
  BPA_OPTION(double, fattening, 1, (0, 2), "Times the usual growth of silhouettes; 0 = none.");
  BPA_OPTION(double, dropouts, 1, (0, 10), "Times the usual chance that a pixel has no depth.");
  BPA_OPTION(bool, registered, true, (0, 1),
             "Measure from beside the colour camera and carry over.");
  BPA_OPTION(double, color_baseline, -0.015, (-0.5, 0.5),
             "Left infrared to colour camera, metres to the right.");
  BPA_OPTION(double, min_range, 0.45, (0, 20), "Nearest depth measured, metres.");
  BPA_OPTION(double, max_range, 10, (0, 20), "Farthest depth measured, metres.");
};

/// As the Kinect's.
Frame simulate_depth(const SensorView& view, const ActiveStereoOptions& options, std::uint64_t seed,
                     int shot = 0, int num_threads = 0);

}  // namespace bpa::sim
