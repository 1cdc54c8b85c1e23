// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "core/geometry/pose.hpp"

// Smooth motions within limits of speed.

namespace bpa::sim {

/// Minimum jerk (Flash and Hogan 1985): 0 at 0, 1 at 1, at rest at both ends and beyond.
double smooth_start_and_stop(double u);
/// 0 at 0 and 1, 1 half way; at rest at the ends and beyond.
double smooth_bump(double u);

struct SpeedLimits {
  double linear = 0.5;   ///< Of the origin of the moving frame, m/s.
  double angular = 1.5;  ///< rad/s
};

/// Poses over [0, 1].
using PosePath = std::function<Pose(double u)>;

/// The shortest time to follow a path within the limits, seconds, by differences of 500 steps.
double seconds_of(const PosePath& path, const SpeedLimits& limits);

/// How a camera moves round a point.
struct OrbitRanges {
  double min_distance = 0.7, max_distance = 1.1;  ///< Metres.
  double min_elevation = 0.5, max_elevation = 1;  ///< Radians above the horizon.
};

/// A camera that looks at the table about the origin and wanders on an orbit: azimuth, elevation,
/// distance, roll and target are sines of their own periods. Its largest speed is a random share,
/// from 0.6 on, of the limit that it meets first. Limits of 0 make it stand still.
class Orbit {
 public:
  Orbit(const OrbitRanges& ranges, const SpeedLimits& limits, std::uint64_t seed);
  /// At a time from 0 to 60 s.
  Pose world_from_camera(double seconds) const;

 private:
  struct Wave {
    double middle = 0, amplitude = 0, frequency = 0, phase = 0;  // frequency: rad/s
    double at(double seconds) const;
  };
  Pose at(double unscaled) const;

  Wave azimuth_, elevation_, distance_, roll_, target_x_, target_y_;
  double scale_ = 1;  // of time
};

}  // namespace bpa::sim
