// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa::features {

/// Where a surface ends: at a range edge or a crease.
struct RimPoint {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;   ///< Of the surface.
  Eigen::Vector3f outward;  ///< In the tangent plane, away from the surface; unit length.
};

/// Cosine of the angle between normals of one face, at least. Chosen by hand.
constexpr float kSameFace = 0.7f;

/// What is at a point of a surface's tangent plane.
enum class Beside : std::uint8_t {
  surface,  ///< The surface goes on.
  end,      ///< It has ended: nothing is there, or surface of another direction.
  hidden,   ///< Something in front hides the point.
  unknown,
};

/// The rims within 2 cm of `points`, which have normals: at most one beside each point. `look` says
/// what is at a point (metres, the cloud's frame) of the tangent plane that has this normal. A rim
/// is exact to about 2 mm where the surface is flat. `look` is called by `num_threads` threads (0:
/// one per core).
std::vector<RimPoint> find_rims(
    const PointCloud& points,
    const std::function<Beside(const Eigen::Vector3f& at, const Eigen::Vector3f& normal)>& look,
    int num_threads = 1);

}  // namespace bpa::features
