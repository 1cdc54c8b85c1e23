// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/frame.hpp"
#include "core/cloud/sensor_kind.hpp"
#include "core/sim/active_stereo.hpp"
#include "core/sim/kinect.hpp"
#include "core/sim/time_of_flight.hpp"

// A depth camera of one of several kinds with the colour camera beside it.

namespace bpa::sim {

/// The colour image has exposure, white balance, blur and noise of its own.
struct ColorCameraOptions {
  BPA_OPTION(double, misregistration, 0, (0, 50), "Shift of colour against depth, pixels.");
  BPA_OPTION(double, color_noise, 1, (0, 10), "Times the usual noise of colours.");
  BPA_OPTION(double, exposure_spread, 0.12, (0, 2), "Standard deviation of the log exposure.");
  BPA_OPTION(double, white_balance_spread, 0.036, (0, 2),
             "Standard deviation of the log gain of each colour.");
};

/// Every effect can be turned down to none. Only the options of `kind` count.
struct SensorOptions {
  SensorKind kind = SensorKind::structured_light;
  BPA_INLINE_GROUP(KinectOptions, kinect);
  BPA_GROUP(ActiveStereoOptions, active_stereo, "Two infrared cameras and a projector.");
  BPA_GROUP(TimeOfFlightOptions, time_of_flight, "The phase of modulated light.");
  BPA_INLINE_GROUP(ColorCameraOptions, color);
};

/// A camera's two images, and the truth about them.
struct SensorImage {
  Frame frame;          ///< As measured.
  RenderedImage ideal;  ///< The same view without any error.
};

/// What the sensor measures. Another `shot` (from 0) of one seed is the same camera a moment later:
/// it has other noise. The same options and seed give the same image for any number of threads.
SensorImage simulate_sensor(const SensorView& view, const SensorOptions& options,
                            std::uint64_t seed, int shot = 0, int num_threads = 0);

}  // namespace bpa::sim
