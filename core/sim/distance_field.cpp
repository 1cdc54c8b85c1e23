// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bpa::sim {

double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& half_size, double rounding) {
  const Eigen::Vector3d q = (p.cwiseAbs() - half_size).array() + rounding;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double rectangle_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& half_size,
                          double rounding) {
  const Eigen::Vector2d q = (p.cwiseAbs() - half_size).array() + rounding;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double capsule_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b, double radius_a, double radius_b) {
  const Eigen::Vector3d axis = b - a;
  const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - t * axis).norm() - (radius_a + t * (radius_b - radius_a));
}

double cylinder_distance(const Eigen::Vector3d& p, double radius, double half_height,
                         double rounding) {
  return rectangle_distance({p.head<2>().norm(), p.z()}, {radius, half_height}, rounding);
}

double torus_xz_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius,
                         double thickness) {
  const Eigen::Vector3d q = p - center;
  return Eigen::Vector2d(std::hypot(q.x(), q.z()) - radius, q.y()).norm() - thickness;
}

double polygon_distance(const Eigen::Vector2d& p, const Profile& corners) {
  double squared = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d edge = corners[j] - corners[i];
    const Eigen::Vector2d to_point = p - corners[i];
    const double t = std::clamp(to_point.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    squared = std::min(squared, (to_point - t * edge).squaredNorm());
    const bool straddles = (corners[i].y() > p.y()) != (corners[j].y() > p.y());
    if (straddles && p.x() < corners[i].x() + edge.x() * to_point.y() / edge.y()) {
      inside = !inside;
    }
  }
  return inside ? -std::sqrt(squared) : std::sqrt(squared);
}

Profile mirrored(const Profile& profile) {
  Profile polygon = profile;
  for (std::size_t i = profile.size(); i-- > 0;) {
    if (profile[i].x() > 0) polygon.push_back({-profile[i].x(), profile[i].y()});
  }
  return polygon;
}

double extruded(double planar_distance, double height, double half_height, double rounding) {
  const Eigen::Vector2d q(planar_distance + rounding, std::abs(height) - half_height + rounding);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double smooth_union(double a, double b, double blend) {
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - h * h * blend / 4;
}

double smooth_difference(double a, double b, double blend) { return -smooth_union(-a, b, blend); }

}  // namespace bpa::sim
