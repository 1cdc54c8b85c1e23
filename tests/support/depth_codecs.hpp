// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/wall_messages.hpp"

// What a camera's image_transport plugins send, made here for the decoders of the server.

namespace bpa::support {

/// The encoder of Wilson's RVL paper, in its own words: runs of zeros and others, numbers in
/// nibbles.
class RvlEncoder {
 public:
  static std::vector<std::uint8_t> encode(const std::vector<std::uint16_t>& depth) {
    RvlEncoder encoder;
    std::size_t at = 0;
    int previous = 0;
    while (at < depth.size()) {
      const std::size_t zeros_from = at;
      while (at < depth.size() && depth[at] == 0) ++at;
      encoder.number(static_cast<int>(at - zeros_from));
      std::size_t end = at;
      while (end < depth.size() && depth[end] != 0) ++end;
      encoder.number(static_cast<int>(end - at));
      for (; at < end; ++at) {
        const int delta = depth[at] - previous;
        encoder.number(delta >= 0 ? 2 * delta : -2 * delta - 1);
        previous = depth[at];
      }
    }
    while (encoder.nibbles_ != 0) encoder.nibble(0);
    return encoder.bytes_;
  }

 private:
  void number(int value) {
    do {
      const int rest = value >> 3;
      nibble(static_cast<std::uint32_t>((value & 7) | (rest != 0 ? 8 : 0)));
      value = rest;
    } while (value != 0);
  }
  void nibble(std::uint32_t four_bits) {
    word_ = word_ << 4U | four_bits;
    if (++nibbles_ < 8) return;
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes_.push_back(static_cast<std::uint8_t>(word_ >> shift));
    }
    word_ = 0;
    nibbles_ = 0;
  }

  std::vector<std::uint8_t> bytes_;
  std::uint32_t word_ = 0;
  int nibbles_ = 0;
};

inline std::vector<std::uint8_t> png16(const std::vector<std::uint16_t>& values) {
  cv::Mat image(static_cast<int>(kHeight), static_cast<int>(kWidth), CV_16UC1);
  std::memcpy(image.data, values.data(), 2 * values.size());
  std::vector<std::uint8_t> file;
  cv::imencode(".png", image, file);
  return file;
}

/// 12 bytes: the plugin's format number and the two floats of inverse depth.
inline std::vector<std::uint8_t> depth_header(float a = 0, float b = 0) {
  std::vector<std::uint8_t> header(12);
  std::memcpy(header.data() + 4, &a, 4);
  std::memcpy(header.data() + 8, &b, 4);
  return header;
}

inline wire::sensor_msgs::CompressedImage compressed_depth(std::int64_t stamp_ns, bool rvl) {
  wire::sensor_msgs::CompressedImage image;
  image.header = header(stamp_ns);
  image.format = rvl ? "16UC1; compressedDepth rvl" : "16UC1; compressedDepth png";
  image.data = depth_header();
  std::vector<std::uint8_t> stream = png16(wall_depth_mm());
  if (rvl) {
    stream = RvlEncoder::encode(wall_depth_mm());
    const std::uint32_t size[2] = {kWidth, kHeight};
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(size);
    stream.insert(stream.begin(), bytes, bytes + sizeof size);
  }
  image.data.insert(image.data.end(), stream.begin(), stream.end());
  return image;
}

/// The wall's colours as a lossless PNG file, as compressed_image_transport writes it.
inline wire::sensor_msgs::CompressedImage compressed_color(std::int64_t stamp_ns,
                                                           const std::string& extension = ".png") {
  wire::sensor_msgs::CompressedImage image;
  image.header = header(stamp_ns);
  image.format = "rgb8; png compressed bgr8";
  const std::vector<std::uint8_t> rgb = wall_rgb();
  cv::Mat bgr(static_cast<int>(kHeight), static_cast<int>(kWidth), CV_8UC3);
  for (std::size_t i = 0; i < rgb.size(); ++i) bgr.data[i - i % 3 + 2 - i % 3] = rgb[i];
  cv::imencode(extension, bgr, image.data);
  return image;
}

}  // namespace bpa::support
