// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/camera.hpp"

namespace bpa::camera {

enum class PixelFormat {
  depth_mm,  ///< uint16, millimetres; 0: not measured.
  depth_m,   ///< float, metres; 0: not measured.
  rgb,       ///< 3 bytes: red, green, blue.
  grey       ///< 1 byte.
};

constexpr std::size_t bytes_per_pixel(PixelFormat format) {
  constexpr std::size_t kBytes[] = {2, 4, 3, 1};
  return kBytes[static_cast<std::size_t>(format)];
}

/// Row-major pixels without padding, little-endian.
struct Image {
  PixelFormat format = PixelFormat::depth_mm;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bytes;  ///< width * height * bytes_per_pixel(format).
};

/// Depth and colour of one moment.
struct SensorImages {
  std::int64_t stamp_ns = 0;  ///< Time of exposure, Unix time of this machine.
  Image depth;
  std::optional<Image> color;      ///< Nothing: the camera gave depth alone.
  Camera camera;                   ///< Pinhole camera of both images.
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3 ... of both images; empty: none. At most 8.
};

}  // namespace bpa::camera
