// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/parts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

namespace geometry = wire::geometry_msgs;
using wire::visualization_msgs::Marker;

/// Well separated hues: steps of the golden ratio round the colour circle.
wire::std_msgs::ColorRGBA color_of(int number, float alpha) {
  const double hue = 6.0 * std::fmod(number * 0.6180339887498949, 1.0);
  const auto channel = [hue](double shift) {
    const double distance = std::abs(std::fmod(hue + shift, 6.0) - 3.0) - 1.0;
    return static_cast<float>(std::clamp(distance, 0.15, 1.0));
  };
  return {channel(0), channel(4), channel(2), alpha};
}

}  // namespace

wire::std_msgs::Header header_message(std::int64_t stamp_ns, const std::string& frame_id) {
  return {wire::builtin_interfaces::from_ns(stamp_ns), frame_id};
}

geometry::Pose pose_message(const Pose& pose) {
  const auto& q = pose.rotation;
  return {xyz<geometry::Point>(pose.translation), {q.x(), q.y(), q.z(), q.w()}};
}

geometry::PoseWithCovariance pose_message(const Pose& pose,
                                          const Eigen::Matrix<double, 6, 6>& covariance) {
  geometry::PoseWithCovariance message;
  message.pose = pose_message(pose);
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor>::Map(message.covariance.data()) = covariance;
  return message;
}

geometry::Transform transform_message(const Pose& pose) {
  return {xyz<geometry::Vector3>(pose.translation), pose_message(pose).orientation};
}

wire::bpa_msgs::Bingham bingham_message(const OrientationUncertainty& orientation) {
  wire::bpa_msgs::Bingham message;
  Eigen::Matrix<double, 4, 3>::Map(message.axes.data()) = orientation.axes;
  Eigen::Vector3d::Map(message.concentrations.data()) = orientation.concentrations;
  return message;
}

wire::vision_msgs::BoundingBox3D box_message(const Pose& pose, int model_number,
                                             const Models& models) {
  wire::vision_msgs::BoundingBox3D message;
  Pose center = pose;
  for (const auto& model : models) {
    if (model->number != model_number) continue;
    const Eigen::AlignedBox3d box = box_of(*model);
    center.translation = center * box.center();
    message.size = xyz<geometry::Vector3>(box.sizes());
  }
  message.center = pose_message(center);
  return message;
}

Marker clearing_marker(const wire::std_msgs::Header& header) {
  Marker clear;
  clear.header = header;
  clear.action = Marker::kDeleteall;
  return clear;
}

void add_markers(const wire::std_msgs::Header& header, const LabelledBox& labelled,
                 double lifetime_s, wire::visualization_msgs::MarkerArray& markers) {
  Marker marker;
  marker.header = header;
  marker.ns = "boxes";
  marker.id = labelled.id;
  marker.type = Marker::kCube;
  marker.action = Marker::kAdd;
  const auto lifetime =
      wire::builtin_interfaces::from_ns(static_cast<std::int64_t>(lifetime_s * 1e9));
  marker.lifetime = {lifetime.sec, lifetime.nanosec};
  marker.pose = labelled.box.center;
  marker.scale = labelled.box.size;
  marker.color = color_of(labelled.model_number, labelled.alpha);
  markers.markers.push_back(marker);
  marker.ns = "names";
  marker.type = Marker::kTextViewFacing;
  marker.scale = {0, 0, 0.03};
  marker.color = {1, 1, 1, 1};
  marker.text = labelled.text;
  markers.markers.push_back(std::move(marker));
}

}  // namespace bpa::server
