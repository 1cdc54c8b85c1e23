// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cloud/point_cloud.hpp"

// Simple triangle meshes with known surfaces.

namespace bpa::test {

/// Two triangles a b c d, counter-clockwise seen from outside.
inline void add_quad(TriangleMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                     const Eigen::Vector3f& c, const Eigen::Vector3f& d) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& corner : {a, b, c, d}) mesh.vertices.push_back(corner);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A box about `centre`, faces outwards.
inline void add_box(TriangleMesh& mesh, const Eigen::Vector3f& half,
                    const Eigen::Vector3f& centre = Eigen::Vector3f::Zero()) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      Eigen::Vector3f n = side * Eigen::Vector3f::Unit(axis);
      Eigen::Vector3f u = Eigen::Vector3f::Unit((axis + 1) % 3);
      Eigen::Vector3f v = n.cross(u);
      n = n.cwiseProduct(half), u = u.cwiseProduct(half), v = v.cwiseProduct(half);
      add_quad(mesh, centre + n - u - v, centre + n + u - v, centre + n + u + v,
               centre + n - u + v);
    }
  }
}

inline TriangleMesh box_mesh(const Eigen::Vector3f& half) {
  TriangleMesh mesh;
  add_box(mesh, half);
  return mesh;
}

/// Half edges and centres of the two overlapping boxes of an L: a foot along x and a tower at its
/// end, without any symmetry.
struct LShape {
  Eigen::Vector3f foot_half{0.070f, 0.035f, 0.020f};
  Eigen::Vector3f foot_centre{0, 0, 0};
  Eigen::Vector3f tower_half{0.020f, 0.035f, 0.060f};
  Eigen::Vector3f tower_centre{-0.050f, 0, 0.040f};
};

inline TriangleMesh l_mesh(const LShape& shape = {}) {
  TriangleMesh mesh;
  add_box(mesh, shape.foot_half, shape.foot_centre);
  add_box(mesh, shape.tower_half, shape.tower_centre);
  return mesh;
}

/// The surface that a curve (radius, z) sweeps about the z axis; outwards is to the right of the
/// direction of travel (up the outside, down the inside).
template <class Curve>
void add_lathe(TriangleMesh& mesh, const Curve& curve, int steps = 96) {
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    for (int s = 0; s < steps; ++s) {
      const auto at = [&](std::size_t row, int step) {
        const double angle = 2 * M_PI * step / steps;
        const auto& [radius, z] = curve[row];
        return Eigen::Vector3f(static_cast<float>(radius * std::cos(angle)),
                               static_cast<float>(radius * std::sin(angle)), static_cast<float>(z));
      };
      add_quad(mesh, at(k, s), at(k, s + 1), at(k + 1, s + 1), at(k + 1, s));
    }
  }
}

inline TriangleMesh sphere_mesh(double radius) {
  std::vector<std::pair<double, double>> curve;
  for (int k = 0; k <= 48; ++k) {
    const double angle = M_PI * k / 48 - M_PI / 2;
    curve.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  TriangleMesh mesh;
  add_lathe(mesh, curve);
  return mesh;
}

/// A beaker open at the top: outer radius, wall thickness, height; its foot is at z = 0.
inline TriangleMesh cup_mesh(double radius, double wall, double height) {
  const std::vector<std::pair<double, double>> curve{
      {0, 0},   {radius, 0}, {radius, height}, {radius - wall, height}, {radius - wall, wall},
      {0, wall}};
  TriangleMesh mesh;
  add_lathe(mesh, curve);
  return mesh;
}

/// The same surface with every triangle turned over.
inline TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace bpa::test
