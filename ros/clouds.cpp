// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "core/base/concat.hpp"
#include "core/io/pcd_file.hpp"
#include "idl/wire/time.hpp"
#include "ros/frames.hpp"
#include "ros/images.hpp"

namespace bpa::ros {
namespace {

static_assert(std::endian::native == std::endian::little, "points are copied as they lie");

using wire::sensor_msgs::PointCloud2;
using wire::sensor_msgs::PointField;

constexpr std::uint32_t kFieldBytes = 4;

Status check_layout(const PointCloud2& cloud) {
  if (cloud.height < 2) {
    return invalid_argument("cloud is ", cloud.width, "x", cloud.height,
                            ": it must be organised, one row of points for each row of pixels");
  }
  if (Status status = check_size("cloud", cloud.width, cloud.height); !status.ok()) return status;
  if (cloud.is_bigendian) {
    return Status(StatusCode::unsupported, "cloud is_bigendian is true; it must be false");
  }
  if (std::uint64_t{cloud.point_step} * cloud.width > cloud.row_step) {
    return invalid_argument("cloud row_step is ", cloud.row_step,
                            "; it must be at least width * point_step");
  }
  const std::uint64_t needed = std::uint64_t{cloud.row_step} * cloud.height;
  if (cloud.data.size() == needed) return {};
  return invalid_argument("cloud data has ", cloud.data.size(), " bytes; it must have ", needed,
                          " (row_step * height)");
}

/// Where a field of 4 bytes lies in a point; nothing when the cloud has none of that name.
std::optional<std::uint32_t> offset_of(const PointCloud2& cloud, const char* name, bool any_type) {
  for (const PointField& field : cloud.point_fields) {
    const bool type_fits = field.datatype == PointField::kFloat32 ||
                           (any_type && field.datatype == PointField::kUint32);
    const bool inside =
        cloud.point_step >= kFieldBytes && field.offset <= cloud.point_step - kFieldBytes;
    if (field.name == name && type_fits && inside) return field.offset;
  }
  return std::nullopt;
}

template <class T>
T read(const std::uint8_t* point, std::uint32_t offset) {
  T value;
  std::memcpy(&value, point + offset, sizeof value);
  return value;
}

Result<io::PcdCloud> points_of(const PointCloud2& cloud) {
  if (Status status = check_layout(cloud); !status.ok()) return status;
  const auto x = offset_of(cloud, "x", false);
  const auto y = offset_of(cloud, "y", false);
  const auto z = offset_of(cloud, "z", false);
  if (!x || !y || !z) {
    return invalid_argument("cloud fields must have x, y and z as FLOAT32 inside point_step");
  }
  auto rgb = offset_of(cloud, "rgb", true);
  if (!rgb) rgb = offset_of(cloud, "rgba", true);
  io::PcdCloud points;
  points.width = static_cast<int>(cloud.width);
  points.height = static_cast<int>(cloud.height);
  points.points.reserve(std::size_t{cloud.width} * cloud.height);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const std::uint8_t* point = cloud.data.data() + row * cloud.row_step;
    for (std::size_t column = 0; column < cloud.width; ++column, point += cloud.point_step) {
      points.points.emplace_back(read<float>(point, *x), read<float>(point, *y),
                                 read<float>(point, *z));
      if (!rgb) continue;
      const auto packed = read<std::uint32_t>(point, *rgb);  // 0xAARRGGBB
      points.colors.push_back({static_cast<std::uint8_t>(packed >> 16U),
                               static_cast<std::uint8_t>(packed >> 8U),
                               static_cast<std::uint8_t>(packed)});
    }
  }
  return points;
}

}  // namespace

DecodedFrame frame_from_cloud(const PointCloud2& cloud, double unit) {
  const auto points = points_of(cloud);
  if (!points.ok()) return {RejectionCause::cloud, points.status()};
  auto organised = io::frame_from_organised_cloud(*points, nullptr, unit);
  if (!organised.ok()) {
    Status status = organised.status();
    status.message += " (frame_id \"" + cloud.header.frame_id + "\")";
    return {RejectionCause::cloud, status};
  }
  if (!organised->cloud_from_camera.rotation.isApprox(Eigen::Quaterniond::Identity())) {
    return {RejectionCause::cloud,
            invalid_argument("cloud has y up and z toward the viewer; it must be in an optical "
                             "frame (x right, y down, z forward)")};
  }
  Frame frame = std::move(organised->frame);
  frame.stamp_ns = to_ns(cloud.header.stamp);
  frame.frame_id = cloud.header.frame_id;
  clean_depth(frame);
  if (Status status = validate(frame); !status.ok()) return {RejectionCause::frame, status};
  const auto& notes = organised->notes;  // the first is of the camera
  return {std::move(frame), notes.size() > 1 ? notes.back() : ""};
}

}  // namespace bpa::ros
