// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/align/posterior.hpp"

// What the isotropic derivation leaves out. Claims 1 and 2 need Σi = σi² I: then |R x + t - y|²
// depends on R through xᵀRᵀy only, which is linear in R and so quadratic in q. A general Σi leaves
// (R x)ᵀ Σi⁻¹ (R x), quartic in q: the posterior is no Bingham, and position and orientation no
// longer come apart. The Bingham is then a proposal, and importance weights correct it. A position
// prior that is not isotropic is the same case.

namespace bpa::align {

/// The true covariances of scene points, camera frame, m²: parallel to Correspondences::oriented
/// and
/// ::positions, or empty where σ² I is meant. The pairs' σ should stand for them, as the root of
/// the mean variance does.
struct Anisotropy {
  std::span<const Eigen::Matrix3d> oriented = {};
  std::span<const Eigen::Matrix3d> positions = {};
};

/// The best pose under the true covariances near `start` and the Gaussian there.
struct RefinedPose {
  Pose camera_from_object;
  /// Inverse curvature of the log posterior, (x, y, z, rotX, rotY, rotZ) as Posterior::covariance.
  /// What the data say nothing about has the variance of a uniform rotation angle, or 1 m².
  Matrix6d covariance = Matrix6d::Identity();
  int iterations = 0;
  bool converged = false;
};
RefinedPose refine(const Correspondences& data, const Anisotropy& anisotropy, const Pose& start,
                   int max_iterations = 30);

/// A draw of camera_from_object with its importance weight.
struct WeightedPose {
  Pose camera_from_object;
  double weight = 1;
};

/// Draws from the joint posterior p(q, t | Z) with importance weights against it.
struct SampledPosterior {
  std::vector<WeightedPose> samples;  ///< Weights sum to 1.
  /// (Σ w)² / Σ w²: how many equally weighted draws these are worth, at most their number.
  double effective_sample_size = 0;
};

/// Samples orientations from the Bingham mixture of the isotropic model. Where the true posterior
/// is anisotropic, also from Binghams of its shape at its maxima. Positions come from their exact
/// Gaussian given the orientation. Weights are those of the true posterior, over both signs of open
/// curvature directions; all equal in the isotropic case.
SampledPosterior sample_posterior(const Correspondences& data, const Anisotropy& anisotropy,
                                  int count, RandomStream& random,
                                  const PosteriorOptions& options = {});

}  // namespace bpa::align
