// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/symmetry.hpp"
#include "core/model/distance_transform.hpp"

namespace bpa {

/// A surface as near_symmetries() reads it: metres, in the object's frame.
struct SelfSurface {
  std::span<const Eigen::Vector3f> points;   ///< Of which `sample` are laid onto the others.
  std::span<const Eigen::Vector3f> normals;  ///< Unit length, outward; one for each point.
  std::span<const std::uint32_t> sample;     ///< Indices into points.
  const DistanceTransform& distances;        ///< Of all points.
  double diameter = 0;
};

/// Motions that lay most of a surface onto itself and are not in `exact`. Most: 60 % of the sample,
/// within 3 % of the diameter and of similar normals. Examples: a mug turned about its axis, a box
/// whose ends differ in the label only. Seen from few sides, pose and pose * motion look the same.
/// Tries turns about the principal axes and the object frame's axes in steps of 15 degrees, each
/// refined. Best first, at most 40. Deterministic.
std::vector<Pose> near_symmetries(const SelfSurface& surface, const SymmetryGroup& exact);

}  // namespace bpa
