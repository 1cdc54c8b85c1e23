// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/geometry/pose.hpp"
#include "core/result/placement.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/geometry_msgs.hpp"
#include "idl/wire/msg/std_msgs.hpp"
#include "idl/wire/msg/vision_msgs.hpp"
#include "idl/wire/msg/visualization_msgs.hpp"
#include "server/convert/results.hpp"

// Parts that messages of results and of tracks have in common.

namespace bpa::server {

wire::std_msgs::Header header_message(std::int64_t stamp_ns, const std::string& frame_id);

/// A message of three numbers, such as a Point or a Vector3.
template <class Message>
Message xyz(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

wire::geometry_msgs::Pose pose_message(const Pose& pose);
wire::geometry_msgs::PoseWithCovariance pose_message(const Pose& pose,
                                                     const Eigen::Matrix<double, 6, 6>& covariance);
/// The same transform as a geometry_msgs/Transform.
wire::geometry_msgs::Transform transform_message(const Pose& pose);
wire::bpa_msgs::Bingham bingham_message(const OrientationUncertainty& orientation);

/// The box of a model along its axes, at a pose; a point for a model that is not there.
wire::vision_msgs::BoundingBox3D box_message(const Pose& pose, int model_number,
                                             const Models& models);

/// A marker that deletes those of the last frame.
wire::visualization_msgs::Marker clearing_marker(const wire::std_msgs::Header& header);
/// A box and its text, with one id in the namespaces "boxes" and "names". The colour follows the
/// model's number; `lifetime_s` 0 is for ever.
struct LabelledBox {
  std::int32_t id = 0;
  wire::vision_msgs::BoundingBox3D box;
  int model_number = 0;
  std::string text;
  float alpha = 0.5f;
};
void add_markers(const wire::std_msgs::Header& header, const LabelledBox& labelled,
                 double lifetime_s, wire::visualization_msgs::MarkerArray& markers);

}  // namespace bpa::server
