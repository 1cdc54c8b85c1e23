// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/oriented_point.hpp"

#include <algorithm>
#include <cmath>

namespace bpa::align {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// A unit vector orthogonal to a unit vector.
Vector3d any_orthogonal(const Vector3d& n) {
  const Vector3d other = std::abs(n.x()) < 0.6 ? Vector3d::UnitX() : Vector3d::UnitY();
  return n.cross(other).normalized();
}

// Concentrations k of two von Mises densities on the circle (twist about the normal) and of two von
// Mises-Fisher densities on the sphere (tilt of the normal) combine by the product of their mean
// resultant lengths. These forms have the right limits: a b / 2 and a b / 3 for small ones,
// 1 / (1/a + 1/b) corrected to next order for large ones.
double compose_twist(double a, double b) {
  const double ab = a * b;
  return ab / (a + b - 1 + 3 / (1 + 0.9 * std::sqrt(ab) + 0.42 * ab));
}

double compose_tilt(double a, double b) {
  const double ab = a * b;
  return ab / (a + b - 1 + 4 / (1 + 0.8 * std::sqrt(ab) + 0.06 * ab));
}

}  // namespace

Quaterniond feature_orientation(const Vector3d& normal, const Vector3d& principal_direction) {
  const Vector3d tangent = principal_direction - normal.dot(principal_direction) * normal;
  const double length = tangent.norm();
  if (!(length > 1e-6 * principal_direction.norm()) || !std::isfinite(length)) {
    return feature_orientation(normal);
  }
  Eigen::Matrix3d columns;
  columns.col(0) = normal;
  columns.col(1) = tangent / length;
  columns.col(2) = normal.cross(columns.col(1));
  return Quaterniond(columns).normalized();
}

Quaterniond feature_orientation(const Vector3d& normal) {
  Eigen::Matrix3d columns;
  columns.col(0) = normal;
  columns.col(1) = any_orthogonal(normal);
  columns.col(2) = normal.cross(columns.col(1));
  return Quaterniond(columns).normalized();
}

double curvature_concentration(double c1, double c2, double kappa) {
  const double larger = std::max(c1, c2);
  const double smaller = std::min(c1, c2);
  if (!(larger > 0)) return 0;
  if (!(smaller > 0)) return kappa;
  return std::max(10 * (1 - larger / smaller), kappa);
}

Bingham feature_bingham(const OrientedPoint& feature) {
  return Bingham::about(feature.orientation,
                        Vector3d(feature.lambda3, feature.kappa, feature.kappa));
}

FeatureConcentration compose(const OrientedPoint& model, const OrientedPoint& scene) {
  // On the circle exp(λ sin²(φ/2)) is von Mises with k = -λ / 2, and so for the tilt.
  FeatureConcentration result;
  const double tilt = model.kappa * scene.kappa;
  if (tilt > 0) result.kappa = -2 * compose_tilt(-0.5 * model.kappa, -0.5 * scene.kappa);
  const double twist = model.lambda3 * scene.lambda3;
  if (twist > 0) result.lambda3 = -2 * compose_twist(-0.5 * model.lambda3, -0.5 * scene.lambda3);
  return result;
}

}  // namespace bpa::align
