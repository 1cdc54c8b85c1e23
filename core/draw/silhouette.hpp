// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/cloud/image.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::draw {

/// The pixels that an object would cover if nothing were in front of it.
struct Silhouette {
  int left = 0;              ///< Column of the mask's first pixel in the image.
  int top = 0;               ///< Row of it.
  Image<std::uint8_t> mask;  ///< 255 on the object, else 0; empty if it is out of sight.
};

/// Draws the points of `surface` (object frame) as discs that reach their neighbours. Models hold
/// points only; where there is a mesh, eval::render_depth is exact.
Silhouette silhouette(const Camera& camera, const PointCloud& surface,
                      const Pose& camera_from_object);

}  // namespace bpa::draw
