// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/base/random.hpp"
#include "core/sim/scenes.hpp"

// Bodies that rest alone on the table, where they stand, and how a hand holds them.

namespace bpa::sim {

/// Where a body stands: its covering circle's centre, metres, and its turn about the vertical.
struct Place {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double yaw = 0;
};

/// From the frame in which a body rests at the origin to the world, `height` metres above the
/// table.
Pose world_from_rest(const Place& place, double height = 0);

/// A body as it rests at the origin: the circle of `radius` about the origin covers it from above.
struct TableBody {
  int mesh = 0;  ///< In the stage's meshes.
  Pose rest_from_object;
  double radius = 0;
  double top = 0;     ///< Height, metres.
  double sphere = 0;  ///< Radius about middle() that holds all of it.
  /// Horizontal, toward the middle of its telltales; zero where it has none.
  Eigen::Vector2d telltale_side = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector3d> points;  ///< Some 2000 of its vertices, at rest.

  Eigen::Vector3d middle() const { return {0, 0, 0.5 * top}; }
};

/// Lets a body fall until it lies still; an upright one begins upright.
TableBody body_at_rest(const Stage& stage, int mesh, bool upright, RandomStream& random);

/// How far a body reaches from its origin along a horizontal direction of unit length.
double reach(const TableBody& body, const Place& place, const Eigen::Vector2d& direction);

/// A hand that holds a body from above.
struct Grip {
  int arm = 0;         ///< Place in make_arms().
  Pose rest_from_arm;  ///< Its forearm may go to the other side as well: turned() says how.

  /// The same fingers with the forearm on the other side.
  Pose turned() const;
};

/// The grip across the narrowest side that is near the top; nothing where none is wide enough.
std::optional<Grip> grip_of(const TableBody& body);

}  // namespace bpa::sim
