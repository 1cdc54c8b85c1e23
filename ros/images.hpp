// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

// Pixels as messages carry them -> pixels as the core takes them. Every size is checked before a
// byte is read; failures name the field, its value and the rule.

namespace bpa::ros {

/// Refuses images that are empty or have a side of more than 8192 pixels.
Status check_size(const std::string& what, std::uint32_t width, std::uint32_t height);

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

/// Row-major metres, 0 where there is no depth. From 16UC1 and mono16 (mm) and 32FC1 (m); NaN,
/// infinite, negative and too large depths become 0. `unsupported` for other encodings.
Result<std::vector<float>> depth_from_image(const ImageView& image);

/// Row-major rgb, 3 bytes a pixel. From rgb8, bgr8, rgba8, bgra8, mono8 and mono16, else
/// `unsupported`.
Result<std::vector<std::uint8_t>> color_from_image(const ImageView& image);

// The same of sensor_msgs/CompressedImage, as ROS 2's image_transport plugins write it. What a file
// says of its size is checked before anything is decoded.

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
/// 16-bit values: millimetres ("16UC1; ...") or inverse depths ("32FC1; ...": z = a / (v - b)).
Result<Decoded<float>> decode_depth(const char* field,
                                    const wire::sensor_msgs::CompressedImage& image);

/// RVL, the lossless coding of depth images of A. D. Wilson, "Fast Lossless Depth Image
/// Compression", 2017: runs of zeros and of other values, the latter as differences to the last
/// one. Numbers are groups of three bits with a fourth that says that more follow. Eight groups
/// make a little-endian word, the first one in its highest bits. Decodes exactly `count` values;
/// false when the stream is too short or does not fit the count.
bool decode_rvl(const std::uint8_t* data, std::size_t size, std::size_t count,
                std::vector<std::uint16_t>& values);

}  // namespace bpa::ros
