// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/frame.hpp"
#include "core/sim/sensor_view.hpp"

// A camera that measures the phase of its own modulated light (Kinect v2, Azure Kinect), simulated
// in steps:
//
//  1. Light. The source stands beside the lens: there are no shadows. The amplitude that returns
//     falls with z^2 and the cosine of incidence. Source: Lange and Seitz 2001, "Solid-state
//     time-of-flight range camera", IEEE J. Quantum Electronics 37.
//  2. Multipath. Light that came by another surface took a longer way and adds to the phasor. One
//     diffuse bounce is summed over 32 directions. Concave corners move away and become round.
//     Planes that stand alone stay where they are. Source: Fuchs 2010, "Multipath interference
//     compensation in time-of-flight camera images", ICPR.
//  3. Flying pixels. Phasors of neighbours mix in a pixel (binomial, 3 x 3), so that at an edge
//  depth
//     lies between both surfaces, by amplitude. Where they cancel too much, the frequencies of the
//     camera disagree and there is no depth. Sources: Wasenmüller and Stricker 2016, "Comparison of
//     Kinect v1 and v2 depth images in terms of accuracy and precision", ACCV workshops;
//     Tölgyessy, Dekan, Chovanec and Hubinský 2021, "Evaluation of the Azure Kinect and its
//     comparison to Kinect V1 and Kinect V2", Sensors 21.
//  4. Noise. Depth gets the axial noise of Fankhauser et al. 2015, "Kinect v2 for mobile robot
//     navigation: evaluation and modeling", ICAR: 1.5 - 0.5 z + 0.3 z^2 + 0.1 z^1.5 angle^2 / (pi/2
//     - angle)^2 mm. It is that of a surface that returns 0.56 of the light (matt and grey). Others
//     have it divided by the root of their share, as shot noise is (Lange and Seitz).
//  5. Holes: where too little light returns (under 0.1 of it at 3.86 m, the range of the Azure
//     Kinect's narrow mode, Microsoft) and where a mirror-like surface saturates the pixel.
//  6. Registration to the colour camera, 3.2 cm to the right. Depth is in millimetres.
//
// The defaults are an Azure Kinect's narrow unbinned mode: 640 x 576 pixels, focal length 505. The
// phase is that of one frequency, 80 MHz, one of the Kinect v2's.

namespace bpa::sim {

/// Every effect can be turned down to none.
struct TimeOfFlightOptions {
  BPA_OPTION(int, width, 640, (64, 4096), "Of the infrared image, pixels.");
  BPA_OPTION(int, height, 576, (64, 4096), "Of the infrared image, pixels.");
  BPA_OPTION(double, infrared_focal, 505, (50, 4000), "Of the infrared image, pixels.");
  BPA_OPTION(double, modulation_hz, 80e6, (1e6, 1e9), "Frequency of the light's modulation.");
  BPA_OPTION(double, axial_noise, 1, (0, 10), "Times the published noise along the axis.");
  BPA_OPTION(double, multipath, 1, (0, 10), "Times the light of one bounce.");
  BPA_OPTION(bool, flying_pixels, true, (0, 1), "Mix surfaces in the pixels of an edge.");
  BPA_OPTION(double, dropouts, 1, (0, 10), "Times the usual chance that a pixel has no depth.");
  BPA_OPTION(bool, registered, true, (0, 1),
             "Measure from beside the colour camera and carry over.");
  BPA_OPTION(double, color_baseline, 0.032, (-0.5, 0.5),
             "Infrared to colour camera, metres to the right.");
  BPA_OPTION(double, min_range, 0.25, (0, 20), "Nearest depth measured, metres.");
  BPA_OPTION(double, max_range, 5.5, (0, 20), "Farthest depth measured, metres.");
};

/// The standard deviation of depth that the model must meet, metres (step 4), for a surface that
/// returns 0.56 of the light from `depth` metres, seen at `angle` radians from its normal.
double published_axial_noise(const TimeOfFlightOptions& options, double depth, double angle);

/// As the Kinect's.
Frame simulate_depth(const SensorView& view, const TimeOfFlightOptions& options, std::uint64_t seed,
                     int shot = 0, int num_threads = 0);

}  // namespace bpa::sim
