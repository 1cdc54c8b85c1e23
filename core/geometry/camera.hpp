// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

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

/// Where a lens shows the point (x, y) of the normalised image plane. `coefficients` are k1 k2 p1
/// p2 k3 k4 k5 k6 of OpenCV's and ROS's plumb_bob and rational_polynomial; those that are left out
/// are 0, more than 8 are ignored.
inline Eigen::Vector2d distort(const std::vector<double>& coefficients, double x, double y) {
  double k[8] = {};
  std::copy_n(coefficients.begin(), std::min<std::size_t>(8, coefficients.size()), k);
  const double r2 = x * x + y * y;
  const double radial =
      (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
          y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
}

}  // namespace bpa
