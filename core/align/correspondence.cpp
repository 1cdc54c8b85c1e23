// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/correspondence.hpp"

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
struct Limits {
  double at_zero, root, square;
};
constexpr Limits kTwist{3, 0.9, 0.42}, kTilt{4, 0.8, 0.06};

// Of exponents λ of two features: on the circle exp(λ sin²(φ/2)) is von Mises with k = -λ / 2, and
// so for the tilt. 0 where either is.
double compose(double first, double second, const Limits& limits) {
  if (!(first * second > 0)) return 0;
  const double a = -0.5 * first, b = -0.5 * second, ab = a * b;
  return -2 * (ab / (a + b - 1 +
                     limits.at_zero / (1 + limits.root * std::sqrt(ab) + limits.square * ab)));
}

// The rotation matrix [n p n×p] of two unit vectors at right angles.
Quaterniond frame_of(const Vector3d& normal, const Vector3d& direction) {
  Eigen::Matrix3d columns;
  columns << normal, direction, normal.cross(direction);
  return Quaterniond(columns).normalized();
}

}  // namespace

Quaterniond feature_orientation(const Vector3d& normal, const Vector3d& principal_direction) {
  const Vector3d tangent = principal_direction - normal.dot(principal_direction) * normal;
  const double length = tangent.norm();
  if (!(length > 1e-6 * principal_direction.norm()) || !std::isfinite(length)) {
    return feature_orientation(normal);
  }
  return frame_of(normal, tangent / length);
}

Quaterniond feature_orientation(const Vector3d& normal) {
  return frame_of(normal, any_orthogonal(normal));
}

OrientedPoint oriented_point(const PointCloud& cloud, std::size_t index, bool with_curvature) {
  OrientedPoint out;
  out.point = cloud.points[index].cast<double>();
  const Vector3d normal = cloud.normals[index].cast<double>();
  if (!with_curvature || cloud.principal_directions.empty() || cloud.curvatures.empty()) {
    out.orientation = feature_orientation(normal);
    return out;
  }
  out.orientation = feature_orientation(normal, cloud.principal_directions[index].cast<double>());
  out.lambda3 = curvature_concentration(cloud.curvatures[index].x(), cloud.curvatures[index].y());
  return out;
}

double curvature_concentration(double c1, double c2, double kappa) {
  const double larger = std::max(c1, c2);
  const double smaller = std::min(c1, c2);
  if (!(larger > 0)) return 0;
  if (!(smaller > 0)) return kappa;
  return std::max(10 * (1 - larger / smaller), kappa);
}

FeatureConcentration compose(const OrientedPoint& model, const OrientedPoint& scene) {
  return {compose(model.kappa, scene.kappa, kTilt), compose(model.lambda3, scene.lambda3, kTwist)};
}

}  // namespace bpa::align
