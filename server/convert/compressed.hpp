// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/status.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

// sensor_msgs/CompressedImage, as ROS 2's image_transport plugins write it, -> pixels. What a file
// says of its size is checked before anything is decoded; failures name the field and the rule.

namespace bpa::server {

template <class Pixel>
struct Decoded {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<Pixel> pixels;
};

/// Row-major rgb, 3 bytes a pixel, from the plugin `compressed`: a JPEG or PNG file. `format` reads
/// "ENCODING; jpeg compressed bgr8"; what stands last, bgr by default, is the order of the channels
/// in the file's own terms.
Result<Decoded<std::uint8_t>> decode_color(const char* field,
                                           const wire::sensor_msgs::CompressedImage& image);

/// Row-major metres, 0 where there is no depth. From the plugin `compressed` (a 16-bit PNG) and
/// from `compressedDepth`: 12 bytes (format, two floats a and b), then a PNG or an RVL stream of
/// 16-bit values, which are millimetres ("16UC1; ...") or inverse depths ("32FC1; ...": z = a / (v
/// - b)).
Result<Decoded<float>> decode_depth(const char* field,
                                    const wire::sensor_msgs::CompressedImage& image);

}  // namespace bpa::server
