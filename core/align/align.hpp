// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/align/correspondence.hpp"
#include "core/base/random.hpp"
#include "core/geometry/pose.hpp"

// Bingham Procrustean Alignment (paper, section II): a distribution over camera_from_object from
// correspondences. Nothing here allocates. README.md derives it; posterior.hpp has the whole
// distribution.

namespace bpa::align {

/// The most probable pose, and the posterior about it.
struct PoseEstimate {
  Pose camera_from_object;  ///< Without positions its translation means nothing.
  /// The orientation's posterior is exp(qᵀ exponent q) / F with the curvature signs chosen here:
  /// Bingham::from_exponent(exponent).
  Eigen::Matrix4d exponent = Eigen::Matrix4d::Zero();
  /// Log likelihood (and log prior ratio) at the mode, relative to perfect agreement: the sum over
  /// pairs of -d² / 2 σ² + λ3 ex² + κ (ey² + ez²). At most 0.
  double log_score = 0;
};

/// The maximum a posteriori pose. With positions only it is Horn's. It also maximises over the
/// signs of curvature directions, by local ascent from several starts: the answer of normals and
/// positions, and both signs of the most concentrated direction. Anisotropic position priors count
/// as isotropic ones of the same mean variance; posterior.hpp corrects for that.
PoseEstimate bpa_mode(const Correspondences& data);

/// One draw of camera_from_object given one correspondence, exact under the model: the scene point
/// is hit with σ per axis; the orientation is drawn from the pair's Bingham, with either sign of
/// the curvature direction unless that is known.
Pose bpa_sample_one(const OrientedPair& pair, RandomStream& random,
                    bool curvature_sign_known = false);

/// The ablation: the same correspondences, positions only (what ICP does between two matchings).
PoseEstimate icp_mode(const Correspondences& data);

}  // namespace bpa::align
