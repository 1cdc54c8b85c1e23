// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/capture/image_messages.hpp"

#include <chrono>

#include "idl/wire/time.hpp"

namespace bpa::server {

wire::std_msgs::Header header_now(const std::string& frame_id) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return {wire::builtin_interfaces::from_ns(
              std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()),
          frame_id};
}

wire::sensor_msgs::Image empty_image(const wire::std_msgs::Header& header, int width, int height,
                                     const char* encoding, std::size_t pixel_bytes) {
  wire::sensor_msgs::Image image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.encoding = encoding;
  image.step = static_cast<std::uint32_t>(pixel_bytes * image.width);
  image.data.resize(std::size_t{image.step} * image.height);
  return image;
}

wire::sensor_msgs::CameraInfo camera_info(const wire::std_msgs::Header& header, const Camera& c,
                                          const std::vector<double>& distortion) {
  wire::sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(c.width);
  info.height = static_cast<std::uint32_t>(c.height);
  info.distortion_model = distortion.size() > 5 ? "rational_polynomial" : "plumb_bob";
  info.d = distortion;
  info.d.resize(distortion.size() > 5 ? 8 : 5, 0.0);
  info.k = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace bpa::server
