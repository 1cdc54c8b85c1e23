// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/frame.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/sensor_kind.hpp"

namespace bpa::track {

/// The large planes (table, wall) that objects stand before. An object that seems to be of their
/// surface is not there.
class Background {
 public:
  /// Finds the planes of a frame, at a coarse resolution.
  void find(const Frame& frame, SensorKind sensor, const Pose& frame_from_camera);

  /// Forgets planes of which a frame shows much less than the one where they were found: the camera
  /// has moved, and nobody said so.
  void check(const Frame& frame, const Pose& frame_from_camera);

  void clear() { planes_.clear(); }
  /// In the tracks' frame of reference.
  const std::vector<Plane>& planes() const { return planes_; }

 private:
  std::vector<Plane> planes_;
  std::vector<double> shares_;  ///< Of the depths of the frame where they were found.
  SensorNoise noise_;
};

}  // namespace bpa::track
