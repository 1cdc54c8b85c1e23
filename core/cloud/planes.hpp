// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/cloud/surface_map.hpp"

namespace bpa {

/// normal . x = offset, the normal toward the camera.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset = 0;
};

struct PlaneOptions {
  double min_extent_m = 0.35;  ///< Smaller planes may be faces of objects and stay.
  double min_fraction = 0.04;  ///< Of the valid pixels, that a plane must hold.
  int max_planes = 3;
  int num_samples = 300;  ///< RANSAC draws per plane.
  std::uint64_t seed = 0;
};

/// The large planes of the scene (table, wall, floor), largest first, by RANSAC with normals;
/// their pixels are labelled background: map.searched becomes 0 there. A plane hides behind
/// objects, so its extent is measured over all its pixels: the square root of the product of the
/// two largest standard deviations, times the square root of 12 (the side of a square of that
/// spread).
std::vector<Plane> label_background_planes(SurfaceMap& map, const PlaneOptions& options);

}  // namespace bpa
