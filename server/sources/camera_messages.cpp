// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <limits>
#include <utility>

#include "idl/wire/time.hpp"
#include "server/sources/frame_source.hpp"

namespace bpa::server {
namespace {

/// By camera::PixelFormat.
constexpr const char* kEncodings[] = {"16UC1", "32FC1", "rgb8", "mono8"};

std::shared_ptr<const ros::AnyImage> image_message(camera::Image image,
                                                   const wire::std_msgs::Header& header) {
  const auto width = static_cast<std::uint32_t>(image.width);
  return std::make_shared<const ros::AnyImage>(wire::sensor_msgs::Image{
      .header = header,
      .height = static_cast<std::uint32_t>(image.height),
      .width = width,
      .encoding = kEncodings[static_cast<std::size_t>(image.format)],
      .step = static_cast<std::uint32_t>(camera::bytes_per_pixel(image.format)) * width,
      .data = std::move(image.bytes)});
}

}  // namespace

ros::CameraImages image_messages(camera::SensorImages images, const std::string& frame_id) {
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
  ros::CameraImages messages;
  messages.depth = image_message(std::move(images.depth), header);
  if (images.color) messages.color = image_message(*std::move(images.color), header);
  messages.info = std::make_shared<const wire::sensor_msgs::CameraInfo>(std::move(info));
  return messages;
}

wire::sensor_msgs::PointCloud2 cloud_message(const Frame& frame) {
  using wire::sensor_msgs::PointField;
  constexpr std::uint32_t kStep = 16;
  wire::sensor_msgs::PointCloud2 cloud;
  cloud.header = {wire::builtin_interfaces::from_ns(frame.stamp_ns), frame.frame_id};
  cloud.width = static_cast<std::uint32_t>(frame.camera.width);
  cloud.height = static_cast<std::uint32_t>(frame.camera.height);
  cloud.point_fields = {{"x", 0, PointField::kFloat32, 1},
                        {"y", 4, PointField::kFloat32, 1},
                        {"z", 8, PointField::kFloat32, 1},
                        {"rgb", 12, PointField::kFloat32, 1}};
  cloud.point_step = kStep;
  cloud.row_step = kStep * cloud.width;
  cloud.data.resize(std::size_t{cloud.row_step} * cloud.height);
  std::uint8_t* out = cloud.data.data();
  std::size_t i = 0;
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u, ++i, out += kStep) {
      Eigen::Vector3f point = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
      if (frame.depth[i] > 0) {
        point = frame.camera.unproject(u, v, frame.depth[i]).cast<float>();
      }
      std::memcpy(out, point.data(), 3 * sizeof(float));
      if (frame.color.empty()) continue;
      const std::uint8_t* rgb = frame.color.data() + 3 * i;
      const std::uint8_t bgr0[4] = {rgb[2], rgb[1], rgb[0], 0};  // 0x00RRGGBB
      std::memcpy(out + 12, bgr0, sizeof bgr0);
    }
  }
  return cloud;
}

}  // namespace bpa::server
