// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/image_messages.hpp"

#include <utility>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

const char* encoding_of(camera::PixelFormat format) {
  constexpr const char* kEncodings[] = {"16UC1", "32FC1", "rgb8", "mono8"};
  return kEncodings[static_cast<std::size_t>(format)];
}

std::shared_ptr<const AnyImage> image_message(camera::Image image,
                                              const wire::std_msgs::Header& header) {
  wire::sensor_msgs::Image message;
  message.header = header;
  message.width = static_cast<std::uint32_t>(image.width);
  message.height = static_cast<std::uint32_t>(image.height);
  message.encoding = encoding_of(image.format);
  message.step = static_cast<std::uint32_t>(camera::bytes_per_pixel(image.format)) * message.width;
  message.data = std::move(image.bytes);
  return std::make_shared<const AnyImage>(std::move(message));
}

}  // namespace

CameraImages image_messages(camera::SensorImages images, const std::string& frame_id) {
  const wire::std_msgs::Header header{wire::builtin_interfaces::from_ns(images.stamp_ns), frame_id};
  const Camera& c = images.camera;
  wire::sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(c.width);
  info.height = static_cast<std::uint32_t>(c.height);
  const bool rational = images.distortion.size() > 5;
  info.distortion_model = rational ? "rational_polynomial" : "plumb_bob";
  info.d = images.distortion;
  info.d.resize(rational ? 8 : 5, 0.0);
  info.k = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0};
  CameraImages messages;
  messages.depth = image_message(std::move(images.depth), header);
  if (images.color) messages.color = image_message(*std::move(images.color), header);
  messages.info = std::make_shared<const wire::sensor_msgs::CameraInfo>(std::move(info));
  return messages;
}

}  // namespace bpa::server
