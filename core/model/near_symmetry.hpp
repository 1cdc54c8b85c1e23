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

/// Motions that lay most of a surface (60 % of the sample, within 3 % of the diameter and facing
/// alike) onto itself and are not in `exact`: a mug turned about its axis, a box whose label alone
/// tells its ends apart. An object that is seen from a few sides only may as well be in pose *
/// motion. Turns about the principal axes and the axes of the object's frame in steps of 15
/// degrees, each moved to where it fits best; best first, at most 40. Deterministic.
std::vector<Pose> near_symmetries(const SelfSurface& surface, const SymmetryGroup& exact);

}  // namespace bpa
