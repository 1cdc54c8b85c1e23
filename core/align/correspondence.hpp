// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/align/oriented_point.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::align {

/// A model point (object frame) and the scene point (camera frame) it is thought to be, whose
/// distance under the true pose is Gaussian with standard deviation sigma along each axis. Metres.
struct PositionPair {
  Eigen::Vector3d model = Eigen::Vector3d::Zero();
  Eigen::Vector3d scene = Eigen::Vector3d::Zero();
  double sigma = 0.005;
};

/// A position pair whose ends also have orientations. lambda3 = 0 on either side leaves a pair of
/// points with normals.
struct OrientedPair {
  OrientedPoint model;
  OrientedPoint scene;
  double sigma = 0.005;  ///< Of the position, metres, along each axis.
};

/// The evidence for one pose, camera_from_object: views, nothing is copied.
struct Correspondences {
  std::span<const OrientedPair> oriented = {};
  std::span<const PositionPair> positions = {};
  const Bingham* orientation_prior = nullptr;  ///< Of camera_from_object's rotation, if any.
  const PositionPrior* position_prior = nullptr;
  /// A curvature direction has no sign of its own: p and -p are both hypotheses. True when the
  /// caller knows that the signs of the two ends agree.
  bool curvature_sign_known = false;
};

}  // namespace bpa::align
