// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/cloud/image.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"

namespace bpa {

/// What an object covers of an image when nothing is in front of it: a rectangle of pixels.
struct Silhouette {
  int left = 0;  ///< Image pixel of the rectangle's first pixel.
  int top = 0;
  Image<std::uint8_t> mask;  ///< 255 on the object, else 0; empty when it is out of sight.
};

/// The points are discs that reach their neighbours. `surface` is in the object's frame.
Silhouette silhouette(const Camera& camera, const PointCloud& surface,
                      const Pose& camera_from_object);

}  // namespace bpa
