// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/sim/sensor.hpp"

// The infrared camera alone of a simulated sensor of any kind.

namespace bpa::sim {

/// Of the infrared image that depth is measured in, pixels.
inline double infrared_focal(const SensorOptions& options) {
  if (options.kind == SensorKind::active_stereo) return options.active_stereo.infrared_focal;
  if (options.kind == SensorKind::time_of_flight) return options.time_of_flight.infrared_focal;
  return options.kinect.infrared_focal;
}

/// The same sensor without registration: depth as it is measured.
inline SensorOptions unregistered(SensorOptions options) {
  options.kinect.registered = options.active_stereo.registered = options.time_of_flight.registered =
      false;
  return options;
}

}  // namespace bpa::sim
