// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/align/align.hpp"
#include "core/bingham/bingham.hpp"

namespace bpa::align {

struct PosteriorOptions {
  int max_hypotheses = 16;        ///< Sign hypotheses kept side by side, 1 or more.
  double smallest_weight = 1e-6;  ///< Hypotheses of a smaller share are rejected, [0, 1).
};

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The whole posterior of camera_from_object under isotropic noise (equation 7 of the paper, and
/// p(t | Z), which it omits). x̄ and ȳ are the centroids weighted by 1 / σ². The model's centroid:
///
///   R x̄ + t ~ N(ȳ, I / weight), independently of the orientation.
///
/// The orientation is a mixture of Binghams, one for each hypothesis of the curvature directions'
/// signs. One Bingham if the signs are known or absent. A value: it does not refer to the
/// correspondences.
struct Posterior {
  PoseEstimate map;            ///< Over signs too; see bpa_mode.
  BinghamMixture orientation;  ///< The heaviest component first.
  double weight = 0;           ///< Σ 1 / σ². 0: no positions, t is left at 0.
  Eigen::Vector3d model_centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d scene_centroid = Eigen::Vector3d::Zero();

  /// An exact draw.
  Pose sample(RandomStream& random) const;
  /// log p(t, q | Z), normalised over R3 x S3 (both signs of q).
  double log_density(const Pose& camera_from_object) const;
  /// Covariance of (x, y, z, rotX, rotY, rotZ) in the order and the fixed axes of ROS: the object's
  /// origin and the rotation vector about the camera's axes, both relative to the MAP pose. From
  /// the component that the MAP pose belongs to; position is linearised in the rotation.
  Matrix6d covariance() const;
};

Posterior posterior(const Correspondences& data, const PosteriorOptions& options = {});

}  // namespace bpa::align
