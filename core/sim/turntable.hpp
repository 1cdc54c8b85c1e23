// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/sim/scenes.hpp"

// What building a model from scans starts from (paper, section on noise-aware models): an object on
// a turntable, seen by a fixed camera, in two or three resting positions.

namespace bpa::sim {

/// How an object is scanned.
struct TurntableOptions {
  BPA_OPTION(int, resting_positions, 2, (1, 6), "Ways the object is put down.");
  BPA_OPTION(double, step_deg, 10, (1, 90), "Turn of the plate between views, degrees.");
  BPA_OPTION(int, max_views, 90, (3, 2000), "Views in all; shared among the resting positions.");
  BPA_OPTION(double, distance, 0.8, (0.4, 3), "Camera to the middle of the plate, metres.");
  BPA_OPTION(double, elevation_deg, 35, (5, 85), "Camera above the plate, degrees.");
  BPA_OPTION(double, spread, 0.03, (0, 0.2),
             "How far off centre the object and the axis are, metres.");
  BPA_OPTION(double, plate_radius, 0.16, (0.05, 0.5), "Of the turning plate, metres.");
  Camera camera{640, 480, 525, 525, 319.5, 239.5};
  BPA_INLINE_GROUP(SensorOptions, sensor);
};

/// One view; the frame's only instance is the object.
struct TurntableView {
  int resting_position = 0;
  double turn = 0;  ///< Radians since the position's first view, counter-clockwise from above.
  SimulatedFrame frame;
};

/// A scan. `axis_in_camera` is what a scanner does not know.
struct TurntableScan {
  std::vector<TurntableView> views;   ///< Grouped by resting position, each from turn 0 on.
  ContinuousSymmetry axis_in_camera;  ///< The plate's axis, upward, in the camera's frame; one for
                                      ///< all views since neither camera nor plate is moved.
};

/// Scans an object. The same input and seed give the same scan for any number of threads.
TurntableScan simulate_turntable(const SimulatedObject& object, const TurntableOptions& options,
                                 std::uint64_t seed, int num_threads = 0);

/// Ways in which an object comes to lie on a level surface, found by letting it fall: at most
/// `count`, the first one drawn first, then the most different. Each on z = 0 about the origin.
std::vector<Pose> resting_poses(const SimulatedObject& object, int count, std::uint64_t seed);

}  // namespace bpa::sim
