// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa {

/// What a pose check reads of one pixel, packed so that a whole image stays in the cache.
struct CheckPixel {
  float depth = 0;                    ///< 0 where there is none.
  std::int8_t normal[3] = {0, 0, 0};  ///< Times 127; zero where unknown.
  std::uint8_t searched = 0;

  /// The normal, unit length; zero where unknown.
  Eigen::Vector3f direction() const {
    return Eigen::Vector3f(normal[0], normal[1], normal[2]) / 127.0f;
  }
};

/// Model points nearer to the camera than this are out of sight, metres: no depth camera sees them.
constexpr float kNearest_m = 0.1f;

/// The observed surface in the form that pose checks read. Pixel (0, 0) is the centre of the top
/// left pixel.
struct CheckImage {
  int width = 0;
  int height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  std::vector<CheckPixel> pixels;  ///< Row by row.
  SensorNoise noise;               ///< Of depth.

  /// The image point of a point of the camera frame with z > 0.
  Eigen::Vector2f project(const Eigen::Vector3f& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  /// Of a pixel inside the image, metres; 0 where there is none.
  float depth_at(int u, int v) const {
    return pixels[static_cast<std::size_t>(v * width + u)].depth;
  }
  /// Whether what is observed hides a predicted depth, being so much in front of it. No observation
  /// (0) hides nothing.
  bool hides(float observed, float predicted, tolerance::Sigmas by = tolerance::kApart) const {
    return observed > 0 && observed < predicted - by(noise(predicted));
  }
  /// The index of the pixel that shows a point of the camera frame; -1 where none does.
  int pixel_of(const Eigen::Vector3f& point) const {
    if (!(point.z() > kNearest_m)) return -1;
    const Eigen::Vector2f at = project(point);
    const float u = at.x() + 0.5f, v = at.y() + 0.5f;
    const bool inside =
        u >= 0 && v >= 0 && u < static_cast<float>(width) && v < static_cast<float>(height);
    return inside ? static_cast<int>(v) * width + static_cast<int>(u) : -1;
  }
};

inline CheckImage make_check_image(const SurfaceMap& map) {
  CheckImage image{.width = map.width(),
                   .height = map.height(),
                   .fx = static_cast<float>(map.camera.fx),
                   .fy = static_cast<float>(map.camera.fy),
                   .cx = static_cast<float>(map.camera.cx),
                   .cy = static_cast<float>(map.camera.cy),
                   .pixels = std::vector<CheckPixel>(map.size()),
                   .noise = map.noise};
  for (std::size_t i = 0; i < map.size(); ++i) {
    CheckPixel& pixel = image.pixels[i];
    pixel.depth = map.depth[i];
    pixel.searched = map.searched[i];
    for (int k = 0; k < 3; ++k) {
      pixel.normal[k] = static_cast<std::int8_t>(std::lround(127 * map.normals[i][k]));
    }
  }
  return image;
}

}  // namespace bpa
