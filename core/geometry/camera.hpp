// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/base/status.hpp"

namespace bpa {

/// A pinhole camera without distortion, in the optical frame: x right, y down, z forward, metres.
/// Pixel (0, 0) is the centre of the top left pixel.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0;  ///< Focal lengths and principal point, pixels.
  double fy = 0;
  double cx = 0;
  double cy = 0;

  /// The point seen at pixel (u, v) at depth z along the optical axis.
  Eigen::Vector3d unproject(double u, double v, double z) const {
    return {(u - cx) / fx * z, (v - cy) / fy * z, z};
  }
  /// The pixel of a point with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  bool contains(double u, double v) const {
    return u >= -0.5 && v >= -0.5 && u < width - 0.5 && v < height - 0.5;
  }
};

/// Names the field, its value and the rule when the camera cannot be used: sizes between 16 and
/// 8192, positive finite focal lengths, a principal point within one image size of the image.
Status validate(const Camera& camera);

}  // namespace bpa
