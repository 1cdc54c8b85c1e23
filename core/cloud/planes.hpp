// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/options.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/geometry/pose.hpp"

namespace bpa {

/// normal . x = offset, the normal toward the camera.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset = 0;

  /// Metres above the plane; negative beneath it.
  float height(const Eigen::Vector3f& point) const { return normal.dot(point) - offset; }
};

struct PlaneOptions {
  BPA_OPTION(bool, label_planes, true, (), "Label large planes (table, wall) as background.");
  BPA_NAMED_OPTION("plane_min_extent_m", double, min_extent_m, 0.35, (0.1, 10),
                   "Smaller planes may be faces of objects and are kept, metres.");
  double min_fraction = 0.04;  ///< Share of the valid pixels that a plane must hold.
  BPA_OPTION(int, max_planes, 3, (0, 100), "Planes that are labelled at most.");
  int num_samples = 300;  ///< RANSAC samples for each plane.
  std::uint64_t seed = 0;
};

/// The large planes of the scene (table, wall, floor), largest first, by RANSAC with normals. Their
/// pixels are labelled background: map.searched becomes 0 there. Objects hide parts of a plane, so
/// its extent is measured over all its pixels. The extent is the side of a square of the same
/// spread: sqrt(12 s1 s2) of the two largest standard deviations. None where `label_planes` is off.
std::vector<Plane> label_background_planes(SurfaceMap& map, const PlaneOptions& options);

/// Labels the map's pixels on a plane as background, as label_background_planes() does.
void label_background(SurfaceMap& map, const Plane& plane);

/// The plane in frame a, from one in frame b.
Plane transformed(const Pose& a_from_b, const Plane& plane);

}  // namespace bpa
