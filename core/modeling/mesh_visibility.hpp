// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// From how many of the directions a point of a mesh is seen, on the side that its triangle's
/// normal points to and on the other.
struct SidesSeen {
  int front = 0;
  int back = 0;
};

constexpr int kNumSeenFrom = 120;  ///< Directions, spread evenly over the sphere.

/// A point on one of a mesh's triangles.
struct MeshPoint {
  Eigen::Vector3f point;
  std::uint32_t triangle = 0;
};

/// Looks at the mesh from kNumSeenFrom directions far away: which of the points are not hidden by
/// its triangles. Exact but for 0.01 mm, so that the two sides of a thin wall are told apart;
/// directions within 15 degrees of a point's tangent plane do not count.
std::vector<SidesSeen> sides_seen(const TriangleMesh& mesh, const std::vector<MeshPoint>& points,
                                  int num_threads);

}  // namespace bpa
