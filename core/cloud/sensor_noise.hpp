// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/frame.hpp"
#include "core/cloud/sensor_kind.hpp"

namespace bpa {

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
