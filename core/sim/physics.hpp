// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"
#include "core/sim/objects.hpp"

// Rigid bodies that fall onto a table and come to rest (Bullet).

namespace bpa::sim {

/// One body and where it is let go; bodies are let go one after the other.
struct FallingBody {
  const SimulatedObject* object = nullptr;
  Pose world_from_object;  ///< Raised if another body already lies that high.
};

/// The table's top is at z = 0, centred on the origin; the floor lies far below.
struct DropOptions {
  double table_half_x = 0.6;
  double table_half_y = 0.45;
  double fence_radius = 0;  ///< Invisible walls while bodies fall, metres; 0 = none.
  double interval = 0.22;   ///< Seconds between bodies.
  double max_seconds = 14;  ///< Of simulated time in all.
  const SimulatedObject* fixture = nullptr;  ///< Stands on the table and does not move.
};

/// How one body ended.
struct RestingBody {
  Pose world_from_object;
  double speed = 0;       ///< Of its centre of mass, m/s.
  double turning = 0;     ///< rad/s
  bool on_table = false;  ///< Not fallen off.
};

/// Lets the bodies fall, takes the walls away and waits until all lie still. Deterministic.
std::vector<RestingBody> drop(const std::vector<FallingBody>& bodies, const DropOptions& options);

/// Centre of mass of a closed mesh of even density.
Eigen::Vector3d center_of_mass(const TriangleMesh& mesh);

}  // namespace bpa::sim
