// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/camera.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

// Pixels as messages carry them -> pixels as the core takes them. Every size is checked before a
// byte is read; failures name the field, its value and the rule.

namespace bpa::server {

/// An image of a message, not copied.
struct ImageView {
  const char* field = "image";  ///< For messages: "color" or "depth".
  std::string encoding;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t step = 0;  ///< Bytes from row to row; 0 means rows without padding.
  bool big_endian = false;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// Row-major metres, 0 where there is no depth. From "16UC1" and "mono16" (millimetres) and "32FC1"
/// (metres); NaN, infinite, negative and too large depths become 0. `unsupported` for other
/// encodings.
Result<std::vector<float>> depth_from_image(const ImageView& image);

/// Row-major rgb, 3 bytes a pixel. From "rgb8", "bgr8", "rgba8", "bgra8" and "mono8"; `unsupported`
/// for other encodings.
Result<std::vector<std::uint8_t>> color_from_image(const ImageView& image);

/// For every pixel of the image without distortion, the index of the nearest pixel of the distorted
/// image, or -1 outside. The camera matrix stays the same. `distortion` as distort() takes it.
std::vector<std::int32_t> undistortion_map(const Camera& camera,
                                           const std::vector<double>& distortion);

}  // namespace bpa::server
