// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/symmetry.hpp"

#include <algorithm>
#include <cmath>

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

// The poses that look the same, each turned about the axis of revolution to be nearest `reference`.
std::vector<Pose> equivalents(const Pose& pose, const Pose& reference, const SymmetryGroup& group) {
  std::vector<Pose> poses = discrete_elements(group);
  for (Pose& each : poses) {
    each = pose * each;
    if (!group.continuous.empty()) each = best_turn(each, reference, group.continuous.front());
  }
  return poses;
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

std::vector<Pose> sampled_elements(const SymmetryGroup& group, int turns) {
  if (group.continuous.empty()) return discrete_elements(group);
  std::vector<Pose> elements;
  for (const Pose& element : discrete_elements(group)) {
    for (int k = 0; k < turns; ++k) {
      elements.push_back(element * rotation_about(group.continuous.front(), 2 * M_PI * k / turns));
    }
  }
  return elements;
}

Pose nearest_symmetric_pose(const Pose& pose, const Pose& reference, const SymmetryGroup& group) {
  const std::vector<Pose> poses = equivalents(pose, reference, group);
  return *std::ranges::min_element(poses, {}, [&](const Pose& candidate) {
    const PoseError error = pose_error(candidate, reference);
    return error.angle + 1e-3 * error.position;
  });
}

PoseError pose_error(const Pose& estimate, const Pose& truth, const SymmetryGroup& group,
                     double position_scale, double angle_scale) {
  std::vector<PoseError> errors;
  for (const Pose& pose : equivalents(truth, estimate, group)) {
    errors.push_back(pose_error(estimate, pose));
  }
  return *std::ranges::min_element(errors, {}, [&](const PoseError& error) {
    return std::max(error.position / position_scale, error.angle / angle_scale);
  });
}

bool within_tolerance(const Pose& a, const Pose& b, const SymmetryGroup& group) {
  const PoseError error = pose_error(a, b, group);
  return error.position < kPoseTolerance_m && error.angle < kPoseTolerance_rad;
}

}  // namespace bpa
