// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace bpa {

/// Points with what is known about the surface at each of them. Every array but `points` is either
/// empty or as long as `points`. Metres. The owner says in which frame.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;               ///< Unit length, out of the surface.
  std::vector<Eigen::Vector3f> principal_directions;  ///< Unit length, in the tangent plane: where
                                                      ///< the normal turns most. Sign arbitrary.
  /// Eigenvalues c1 >= c2 of the covariance of normals in the tangent plane (paper, appendix).
  std::vector<Eigen::Vector2f> curvatures;
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< rgb

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
};

/// The points of these indices, with normals and colours.
inline PointCloud select(const PointCloud& cloud, const std::vector<int>& indices) {
  PointCloud out;
  for (const int i : indices) {
    out.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
    if (!cloud.colors.empty()) out.colors.push_back(cloud.colors[i]);
  }
  return out;
}

/// The points whose index meets a condition.
template <std::predicate<int> Condition>
PointCloud select(const PointCloud& cloud, const Condition& condition) {
  std::vector<int> indices;
  for (int i = 0; i < static_cast<int>(cloud.size()); ++i) {
    if (condition(i)) indices.push_back(i);
  }
  return select(cloud, indices);
}

struct Texture;  // core/cloud/texture.hpp

/// A triangle mesh. Metres once read by io.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;                  ///< Per vertex; may be empty.
  std::vector<std::array<std::uint8_t, 3>> colors;       ///< Per vertex, rgb; may be empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;   ///< Counter-clockwise seen from outside.
  std::vector<std::shared_ptr<const Texture>> textures;  ///< May be empty.
  std::vector<std::int32_t> texture_of;  ///< Per triangle, an index of `textures`; -1: `colors`
                                         ///< hold there. Empty without textures.
  std::vector<Eigen::Vector2f> uv;  ///< Per vertex: u to the right, v up, (0, 0) is the lower left
                                    ///< corner of the image. Empty without textures.
};

}  // namespace bpa
