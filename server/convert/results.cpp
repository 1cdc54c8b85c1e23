// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/results.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;
namespace geometry = wire::geometry_msgs;
namespace vision = wire::vision_msgs;
namespace markers = wire::visualization_msgs;

wire::std_msgs::Header header(std::int64_t stamp_ns, const std::string& frame_id) {
  return {wire::builtin_interfaces::from_ns(stamp_ns), frame_id};
}

/// A message of three numbers, such as a Point or a Vector3.
template <class Message>
Message xyz(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

geometry::Pose pose_message(const Pose& pose) {
  const auto& q = pose.rotation;
  return {xyz<geometry::Point>(pose.translation), {q.x(), q.y(), q.z(), q.w()}};
}

geometry::PoseWithCovariance pose_with_covariance(const Placement& placement) {
  geometry::PoseWithCovariance message;
  message.pose = pose_message(placement.camera_from_object);
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor>::Map(message.covariance.data()) =
      placement.covariance;
  return message;
}

msgs::Bingham bingham_message(const OrientationUncertainty& orientation) {
  msgs::Bingham message;
  Eigen::Matrix<double, 4, 3>::Map(message.axes.data()) = orientation.axes;
  Eigen::Vector3d::Map(message.concentrations.data()) = orientation.concentrations;
  return message;
}

msgs::Placement placement_message(const Placement& placement, std::uint32_t instance) {
  msgs::Placement message{.model = placement.model,
                          .model_number = static_cast<std::uint32_t>(placement.model_number),
                          .instance = instance,
                          .pose = pose_with_covariance(placement),
                          .orientation = bingham_message(placement.orientation),
                          .score = placement.score,
                          .probability = placement.probability,
                          .visible_fraction = placement.visible_fraction,
                          .score_components = {},
                          .alternatives = {}};
  for (const auto& [name, value] : placement.components) {
    message.score_components.push_back({name, value});
  }
  for (const auto& [pose, weight] : placement.alternatives) {
    message.alternatives.push_back({pose_message(pose), weight});
  }
  return message;
}

/// Calls visit(placement, "MODEL_INSTANCE") for the best interpretation.
void for_each_best(const SceneInterpretations& result, auto visit) {
  if (result.interpretations.empty()) return;
  std::map<std::string, int> instances;
  for (const Placement& placement : result.interpretations.front().placements) {
    const int instance = instances[placement.model]++;
    visit(placement, placement.model + "_" + std::to_string(instance));
  }
}

/// The box along the axes; a point for a model without surface.
Eigen::AlignedBox3d box_of(const ObjectModel& model) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : model.surface.points) box.extend(point);
  if (box.isEmpty()) box.extend(Eigen::Vector3f::Zero().eval());
  return box.cast<double>();
}

vision::BoundingBox3D box_message(const Placement& placement, const Models& models) {
  vision::BoundingBox3D message;
  Pose center = placement.camera_from_object;
  for (const auto& model : models) {
    if (model->number != placement.model_number) continue;
    const Eigen::AlignedBox3d box = box_of(*model);
    center.translation = center * box.center();
    message.size = xyz<geometry::Vector3>(box.sizes());
  }
  message.center = pose_message(center);
  return message;
}

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

msgs::Status to_message(const Status& status) {
  return {static_cast<std::uint8_t>(status.code), status.message};
}

std::vector<msgs::StageTiming> to_message(const std::vector<StageTiming>& timings) {
  std::vector<msgs::StageTiming> messages;
  for (const auto& [stage, milliseconds] : timings) messages.push_back({stage, milliseconds});
  return messages;
}

msgs::SceneInterpretations interpretations_message(const Result<SceneInterpretations>& result,
                                                   const ResultContext& context) {
  msgs::SceneInterpretations message;
  message.header = header(context.stamp_ns, context.frame_id);
  message.status = to_message(result.status());
  message.models_searched = static_cast<std::uint32_t>(context.models_searched);
  message.seed = context.seed;
  if (!result.ok()) return message;
  for (const Interpretation& interpretation : result->interpretations) {
    msgs::Interpretation ranked{static_cast<std::uint32_t>(interpretation.rank),
                                interpretation.score,
                                interpretation.probability,
                                {}};
    std::map<std::string, std::uint32_t> instances;
    for (const Placement& placement : interpretation.placements) {
      ranked.placements.push_back(placement_message(placement, instances[placement.model]++));
    }
    message.interpretations.push_back(std::move(ranked));
  }
  message.stage_timings = to_message(result->timings);
  message.total_ms = result->total_milliseconds;
  message.budget_exhausted = result->budget_exhausted;
  message.fused_frames = static_cast<std::uint32_t>(result->fused_frames);
  return message;
}

vision::Detection3DArray detections_message(const SceneInterpretations& result,
                                            const Models& models) {
  vision::Detection3DArray message;
  message.header = header(result.stamp_ns, result.frame_id);
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    message.detections.push_back(
        {message.header,
         {{{placement.model, placement.probability}, pose_with_covariance(placement)}},
         box_message(placement, models),
         name});
  });
  return message;
}

markers::MarkerArray markers_message(const SceneInterpretations& result, const Models& models,
                                     double lifetime_s) {
  markers::MarkerArray message;
  markers::Marker clear;
  clear.header = header(result.stamp_ns, result.frame_id);
  clear.action = markers::Marker::kDeleteall;
  message.markers.push_back(clear);
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    const vision::BoundingBox3D box = box_message(placement, models);
    markers::Marker marker;
    marker.header = clear.header;
    marker.ns = "boxes";
    marker.id = static_cast<std::int32_t>(message.markers.size() / 2);
    marker.type = markers::Marker::kCube;
    marker.action = markers::Marker::kAdd;
    const auto lifetime =
        wire::builtin_interfaces::from_ns(static_cast<std::int64_t>(lifetime_s * 1e9));
    marker.lifetime = {lifetime.sec, lifetime.nanosec};
    marker.pose = box.center;
    marker.scale = box.size;
    marker.color = color_of(placement.model_number, 0.5f);
    message.markers.push_back(marker);
    marker.ns = "names";
    marker.type = markers::Marker::kTextViewFacing;
    marker.scale = {0, 0, 0.03};
    marker.color = {1, 1, 1, 1};
    char percent[16];
    std::snprintf(percent, sizeof percent, " %.0f %%", 100 * placement.probability);
    marker.text = name + percent;
    message.markers.push_back(std::move(marker));
  });
  return message;
}

wire::tf2_msgs::TFMessage transforms_message(const SceneInterpretations& result,
                                             const std::string& prefix) {
  wire::tf2_msgs::TFMessage message;
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    const Pose& pose = placement.camera_from_object;
    message.transforms.push_back(
        {header(result.stamp_ns, result.frame_id),
         prefix + "/" + name,
         {xyz<geometry::Vector3>(pose.translation), pose_message(pose).orientation}});
  });
  return message;
}

wire::sensor_msgs::Image image_message(const SceneInterpretations& result, int width, int height,
                                       std::vector<std::uint8_t> rgb) {
  return {.header = header(result.stamp_ns, result.frame_id),
          .height = static_cast<std::uint32_t>(height),
          .width = static_cast<std::uint32_t>(width),
          .encoding = "rgb8",
          .step = 3 * static_cast<std::uint32_t>(width),
          .data = std::move(rgb)};
}

msgs::ModelInfo model_message(const ObjectModel& model) {
  const Eigen::AlignedBox3d box = box_of(model);
  msgs::ModelInfo message{.name = model.name,
                          .number = static_cast<std::uint32_t>(model.number),
                          .diameter = model.diameter,
                          .box_min = xyz<geometry::Point>(box.min()),
                          .box_max = xyz<geometry::Point>(box.max()),
                          .point_count = static_cast<std::uint32_t>(model.surface.size()),
                          .discrete_symmetries = {},
                          .continuous_symmetries = {}};
  for (const Pose& pose : model.symmetry.discrete) {
    message.discrete_symmetries.push_back(pose_message(pose));
  }
  for (const ContinuousSymmetry& symmetry : model.symmetry.continuous) {
    message.continuous_symmetries.push_back(
        {xyz<geometry::Vector3>(symmetry.axis), xyz<geometry::Point>(symmetry.point)});
  }
  return message;
}

}  // namespace bpa::server
