// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/frame.hpp"
#include "core/cloud/sensor_kind.hpp"

namespace bpa {

/// Standard deviation of depth at distance z, metres: floor + growth * (z - from)^2. The default is
/// a Kinect's (Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise", 3DIMPVT 2012).
struct SensorNoise {
  float floor = 0.0012f;   ///< metres
  float growth = 0.0019f;  ///< per metre
  float from = 0.4f;       ///< metres

  float operator()(float z) const { return floor + growth * (z - from) * (z - from); }
};

/// Active stereo has a RealSense D415's: z^2 * 0.08 pixels / (924 pixels * 55 mm) (Grunnet-Jepsen
/// et al., "Best-known-methods for tuning Intel RealSense D400 depth cameras", Intel 2018) and the
/// rounding to millimetres. Time of flight has a Kinect's: what is published of it is the noise
/// alone (Fankhauser et al., ICAR 2015), and multipath adds to that.
constexpr SensorNoise noise_of(SensorKind kind) {
  if (kind == SensorKind::active_stereo) return {0.0003f, 0.00157f, 0};
  return {};
}

/// What tells the kinds apart in one depth image.
struct SensorTraits {
  bool measured = false;  ///< Enough depths, in whole tenths of a millimetre as sensors give them.
  double noise = 0;       ///< Of depth, from points 5 pixels apart, metres.
  /// Noise of points beside each other over `noise`. 1 if it is white (time of flight), less if
  /// windows overlap (stereo), 0 where depth comes in steps wider than a pixel (structured light).
  double whiteness = 0;
};

/// Reads the frame's depth alone; it must be valid (validate(Frame)).
SensorTraits sensor_traits(const Frame& frame);

/// The kind of sensor that took the frame. structured_light where the frame does not tell: it was
/// rendered, combined of several, or shows too little.
SensorKind sensor_kind_of(const SensorTraits& traits);

}  // namespace bpa
