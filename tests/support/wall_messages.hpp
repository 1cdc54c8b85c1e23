// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/time.hpp"

// Legal messages of a small camera that looks at a slanted wall, for tests to spoil.

namespace bpa::support {

inline constexpr std::uint32_t kWidth = 64;
inline constexpr std::uint32_t kHeight = 48;

inline std::vector<std::uint16_t> wall_depth_mm() {
  std::vector<std::uint16_t> depth(kWidth * kHeight);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = static_cast<std::uint16_t>(700 + 2 * (i % kWidth) + i / kWidth);
  }
  return depth;
}

inline std::vector<std::uint8_t> wall_rgb() {
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<std::uint8_t>(i % 251);
  return rgb;
}

inline wire::std_msgs::Header header(std::int64_t stamp_ns) {
  return {wire::builtin_interfaces::from_ns(stamp_ns), "wall_camera"};
}

template <class T>
std::vector<std::uint8_t> as_bytes(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline wire::bpa_msgs::RgbdFrame wall_frame(std::int64_t stamp_ns = 1'000) {
  wire::bpa_msgs::RgbdFrame frame;
  frame.header = header(stamp_ns);
  frame.width = kWidth;
  frame.height = kHeight;
  frame.color_encoding = "rgb8";
  frame.color = wall_rgb();
  frame.depth_encoding = "16UC1";
  frame.depth = as_bytes(wall_depth_mm());
  frame.k = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
  return frame;
}

inline wire::sensor_msgs::Image wall_color_image(std::int64_t stamp_ns) {
  wire::sensor_msgs::Image image;
  image.header = header(stamp_ns);
  image.width = kWidth;
  image.height = kHeight;
  image.encoding = "rgb8";
  image.step = 3 * kWidth;
  image.data = wall_rgb();
  return image;
}

inline wire::sensor_msgs::Image wall_depth_image(std::int64_t stamp_ns) {
  wire::sensor_msgs::Image image;
  image.header = header(stamp_ns);
  image.width = kWidth;
  image.height = kHeight;
  image.encoding = "16UC1";
  image.step = 2 * kWidth;
  image.data = as_bytes(wall_depth_mm());
  return image;
}

inline wire::sensor_msgs::CameraInfo wall_camera_info(std::int64_t stamp_ns) {
  wire::sensor_msgs::CameraInfo info;
  info.header = header(stamp_ns);
  info.width = kWidth;
  info.height = kHeight;
  info.distortion_model = "plumb_bob";
  info.d = {0, 0, 0, 0, 0};
  info.k = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {58, 0, 31, 0, 0, 58, 23, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace bpa::support
