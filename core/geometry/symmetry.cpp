// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bpa {
namespace {

Pose rotation_about(const ContinuousSymmetry& symmetry, double angle) {
  const Eigen::Quaterniond turn = rotation_from_vector(angle * symmetry.axis);
  return {turn, symmetry.point - turn * symmetry.point};
}

// The rotation about the axis that brings `pose` nearest to `reference`: with the relative rotation
// q = pose^-1 * reference, maximise |<q, (cos h, sin h * axis)>| over the half angle h.
Pose best_turn(const Pose& pose, const Pose& reference, const ContinuousSymmetry& symmetry) {
  const Eigen::Quaterniond relative = pose.rotation.conjugate() * reference.rotation;
  const double half = std::atan2(symmetry.axis.dot(relative.vec()), relative.w());
  return pose * rotation_about(symmetry, 2 * half);
}

}  // namespace

PoseError pose_error(const Pose& a, const Pose& b) {
  return {(a.translation - b.translation).norm(), rotation_angle(a.rotation, b.rotation)};
}

std::vector<Pose> discrete_elements(const SymmetryGroup& group) {
  std::vector<Pose> elements{Pose{}};
  elements.insert(elements.end(), group.discrete.begin(), group.discrete.end());
  return elements;
}

Pose nearest_symmetric_pose(const Pose& pose, const Pose& reference, const SymmetryGroup& group) {
  Pose best = pose;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const Pose& element : discrete_elements(group)) {
    Pose candidate = pose * element;
    if (!group.continuous.empty()) {
      candidate = best_turn(candidate, reference, group.continuous.front());
    }
    const PoseError error = pose_error(candidate, reference);
    const double cost = error.angle + 1e-3 * error.position;
    if (cost < best_cost) {
      best_cost = cost;
      best = candidate;
    }
  }
  return best;
}

PoseError pose_error(const Pose& estimate, const Pose& truth, const SymmetryGroup& group,
                     double position_scale, double angle_scale) {
  PoseError best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const Pose& element : discrete_elements(group)) {
    Pose candidate = truth * element;
    if (!group.continuous.empty()) {
      candidate = best_turn(candidate, estimate, group.continuous.front());
    }
    const PoseError error = pose_error(estimate, candidate);
    const double cost = std::max(error.position / position_scale, error.angle / angle_scale);
    if (cost < best_cost) {
      best_cost = cost;
      best = error;
    }
  }
  return best;
}

}  // namespace bpa
