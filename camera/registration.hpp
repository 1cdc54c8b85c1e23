// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/camera.hpp"

// Depth registered to colour: the depth image as the colour camera would measure it.

namespace bpa::camera {

/// Two cameras side by side, looking the same way: how a device's depth and colour cameras stand.
struct DeviceGeometry {
  Camera depth;
  Camera color;
  std::vector<double> color_distortion;  ///< k1 k2 p1 p2 k3 ...; empty: none. At most 8.
  double baseline = 0.025;               ///< The colour camera is this far to the right, metres.
  double depth_unit = 0.001;             ///< Metres of one unit of depth.
};

/// Carries a depth image (row-major, 0 = nothing measured) over to the colour camera, pixel by
/// pixel: a depth pixel covers the colour pixels that its square falls on, and the nearer surface
/// hides the farther one. Gaps one pixel wide within one surface (depths within 2 %) are closed.
std::vector<std::uint16_t> register_depth(const std::vector<std::uint16_t>& depth,
                                          const DeviceGeometry& geometry);

enum class Alignment { registered, not_registered, cannot_tell };

/// Whether a device really registers depth after it was asked to. `before` and `after` are depth
/// images from before and after the request. Both have the size of the depth camera, which must be
/// that of colour. Only pixels whose depth registration changes by more than 1 % count.
/// `cannot_tell` with fewer than 200 of them (a wall seen squarely), or when most match neither
/// image (the view changed).
Alignment judge_registration(const std::vector<std::uint16_t>& before,
                             const std::vector<std::uint16_t>& after,
                             const DeviceGeometry& geometry);

}  // namespace bpa::camera
