// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/image.hpp"
#include "core/cloud/planes.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {

/// A part of the image on a plane, or a little above it, that differs from it in colour or height.
/// Perhaps a thin object, which depth alone hardly shows. Camera frame, metres.
struct FlatRegion {
  Eigen::Vector3f up;      ///< The plane's normal, toward the camera.
  Eigen::Vector3f centre;  ///< On the plane, in the middle of the region.
  Eigen::Vector3f axis;    ///< The longest direction, in the plane, unit length.
  float length = 0;        ///< Of the rectangle of the same spread.
  float width = 0;
  int pixels = 0;
};

struct FlatRegions {
  std::vector<FlatRegion> regions;  ///< Largest first.
  Image<std::int16_t> label;        ///< Of the map's size: index of the region; -1 for none.
};

/// The regions of 3 to 400 cm², at most 40. A region whose border goes on upward is the foot of a
/// higher object and is left out. `planes` as label_background_planes() gives them. `cielab` may be
/// empty: then height alone tells.
FlatRegions find_flat_regions(const SurfaceMap& map, std::span<const Plane> planes,
                              const Image<Eigen::Vector3f>& cielab);

}  // namespace bpa
