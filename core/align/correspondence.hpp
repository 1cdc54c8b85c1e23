// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "core/bingham/bingham.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::align {

/// The paper's κ: the concentration of a feature's normal (appendix). About each axis the normal
/// tilts with a standard deviation of sqrt(-1 / (2 κ)) * 2 = 8.1 degrees.
inline constexpr double kNormalConcentration = -100;

/// A point with an orientation: the rotation matrix [n p n×p] of its normal and its principal
/// curvature direction (paper, appendix). Both are in the frame of `point`.
///
/// Its uncertainty is a Bingham in the feature's own frame. A deviation e = (ew, ex, ey, ez) has
/// exponent lambda3 ex² + kappa (ey² + ez²). ex turns about the normal; ey and ez tilt it.
struct OrientedPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();                  ///< Metres.
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< Columns n, p, n×p.
  double kappa = kNormalConcentration;  ///< Of the normal, ≤ 0; 0 = no orientation at all.
  double lambda3 = 0;  ///< Of the curvature direction, in [kappa, 0]; 0 = only the normal counts.
};

/// The orientation [n p n×p] of a unit normal and a curvature direction; p is made orthogonal to n.
/// Where p is parallel to n or not finite, any direction orthogonal to n replaces it.
Eigen::Quaterniond feature_orientation(const Eigen::Vector3d& normal,
                                       const Eigen::Vector3d& principal_direction);

/// The same for a normal alone: an arbitrary but fixed direction orthogonal to it.
Eigen::Quaterniond feature_orientation(const Eigen::Vector3d& normal);

/// Point `index` of a cloud with normals; with its curvature direction where that is wanted and the
/// cloud has them.
OrientedPoint oriented_point(const PointCloud& cloud, std::size_t index, bool with_curvature);

/// λ3 = max{10 (1 - c1 / c2), κ} (paper, appendix). The principal curvatures c1 ≥ c2 ≥ 0 are
/// eigenvalues of the covariance of nearby normals. 0 where the surface is flat or round, κ where
/// it bends one way only. 0 when the ratio is not a number, as on a plane without noise.
double curvature_concentration(double c1, double c2, double kappa = kNormalConcentration);

/// The same normal with the curvature direction reversed, q ∘ i: (q1, q2, q3, q4) becomes
/// (-q2, q1, q4, -q3) (paper, appendix).
inline Eigen::Quaterniond reversed_curvature(const Eigen::Quaterniond& q) {
  return Eigen::Quaterniond(-q.x(), q.w(), q.z(), -q.y());
}

/// Concentrations of the deviation between two features seen independently, each with its own.
struct FeatureConcentration {
  double kappa = 0;
  double lambda3 = 0;
};

/// Both the model's and the scene's feature are uncertain, and q = q_scene ∘ q_model⁻¹ inherits
/// both uncertainties. The result's second moments match those of the convolution: exactly where
/// both are concentrated, uniform or zero, within 8 % of the concentration in between (README.md).
FeatureConcentration compose(const OrientedPoint& model, const OrientedPoint& scene);

/// A model point (object frame) and its supposed scene point (camera frame). Under the true pose
/// their offset is Gaussian, standard deviation sigma along each axis. Metres.
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
