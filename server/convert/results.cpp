// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/results.hpp"

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

geometry::Pose pose_message(const Pose& pose) {
  geometry::Pose message;
  message.position = {pose.translation.x(), pose.translation.y(), pose.translation.z()};
  message.orientation = {pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
                         pose.rotation.w()};
  return message;
}

geometry::PoseWithCovariance pose_with_covariance(const Placement& placement) {
  geometry::PoseWithCovariance message;
  message.pose = pose_message(placement.camera_from_object);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      message.covariance[static_cast<std::size_t>(6 * row + column)] =
          placement.covariance(row, column);
    }
  }
  return message;
}

msgs::Bingham bingham_message(const OrientationUncertainty& orientation) {
  msgs::Bingham message;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 4; ++i) {
      message.axes[static_cast<std::size_t>(4 * axis + i)] = orientation.axes(i, axis);
    }
    message.concentrations[static_cast<std::size_t>(axis)] = orientation.concentrations[axis];
  }
  return message;
}

msgs::Placement placement_message(const Placement& placement, std::uint32_t instance) {
  msgs::Placement message;
  message.model = placement.model;
  message.model_number = static_cast<std::uint32_t>(placement.model_number);
  message.instance = instance;
  message.pose = pose_with_covariance(placement);
  message.orientation = bingham_message(placement.orientation);
  message.score = placement.score;
  message.probability = placement.probability;
  message.visible_fraction = placement.visible_fraction;
  for (const ScoreComponent& component : placement.components) {
    message.score_components.push_back({component.name, component.value});
  }
  for (const PoseAlternative& alternative : placement.alternatives) {
    message.alternatives.push_back(
        {pose_message(alternative.camera_from_object), alternative.weight});
  }
  return message;
}

/// Numbers the placements of each model from 0.
class InstanceCounter {
 public:
  std::uint32_t next(const std::string& model) { return counts_[model]++; }

 private:
  std::map<std::string, std::uint32_t> counts_;
};

std::string instance_name(const Placement& placement, std::uint32_t instance) {
  return placement.model + "_" + std::to_string(instance);
}

/// Calls visit(placement, instance) for the best interpretation.
template <class Visit>
void for_each_best(const SceneInterpretations& result, Visit visit) {
  if (result.interpretations.empty()) return;
  InstanceCounter instances;
  for (const Placement& placement : result.interpretations.front().placements) {
    visit(placement, instances.next(placement.model));
  }
}

struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

Box box_of(const ObjectModel& model) {
  Box box;
  if (model.surface.empty()) return box;
  Eigen::Vector3f low = model.surface.points.front(), high = low;
  for (const Eigen::Vector3f& point : model.surface.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  box.min = low.cast<double>();
  box.max = high.cast<double>();
  return box;
}

vision::BoundingBox3D box_message(const Placement& placement, const Models& models) {
  Box box;
  for (const auto& model : models) {
    if (model->number == placement.model_number) box = box_of(*model);
  }
  vision::BoundingBox3D message;
  Pose center = placement.camera_from_object;
  center.translation = placement.camera_from_object * (0.5 * (box.min + box.max));
  message.center = pose_message(center);
  const Eigen::Vector3d size = box.max - box.min;
  message.size = {size.x(), size.y(), size.z()};
  return message;
}

/// Well separated hues: steps of the golden ratio round the colour circle.
wire::std_msgs::ColorRGBA color_of(int number, float alpha) {
  const double hue = 6.0 * std::fmod(number * 0.6180339887498949, 1.0);
  const auto channel = [hue](double shift) {
    const double distance = std::abs(std::fmod(hue + shift, 6.0) - 3.0) - 1.0;
    return static_cast<float>(std::min(1.0, std::max(0.15, distance)));
  };
  return {channel(0), channel(4), channel(2), alpha};
}

}  // namespace

msgs::Status to_message(const Status& status) {
  return {static_cast<std::uint8_t>(status.code), status.message};
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
    msgs::Interpretation ranked;
    ranked.rank = static_cast<std::uint32_t>(interpretation.rank);
    ranked.score = interpretation.score;
    ranked.probability = interpretation.probability;
    InstanceCounter instances;
    for (const Placement& placement : interpretation.placements) {
      ranked.placements.push_back(placement_message(placement, instances.next(placement.model)));
    }
    message.interpretations.push_back(std::move(ranked));
  }
  for (const StageTiming& timing : result->timings) {
    message.stage_timings.push_back({timing.stage, timing.milliseconds});
  }
  message.total_ms = result->total_milliseconds;
  message.budget_exhausted = result->budget_exhausted;
  message.fused_frames = static_cast<std::uint32_t>(result->fused_frames);
  return message;
}

vision::Detection3DArray detections_message(const SceneInterpretations& result,
                                            const Models& models) {
  vision::Detection3DArray message;
  message.header = header(result.stamp_ns, result.frame_id);
  for_each_best(result, [&](const Placement& placement, std::uint32_t instance) {
    vision::Detection3D detection;
    detection.header = message.header;
    vision::ObjectHypothesisWithPose hypothesis;
    hypothesis.hypothesis = {placement.model, placement.probability};
    hypothesis.pose = pose_with_covariance(placement);
    detection.results.push_back(std::move(hypothesis));
    detection.bbox = box_message(placement, models);
    detection.id = instance_name(placement, instance);
    message.detections.push_back(std::move(detection));
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
  std::int32_t id = 0;
  for_each_best(result, [&](const Placement& placement, std::uint32_t instance) {
    const vision::BoundingBox3D box = box_message(placement, models);
    markers::Marker marker;
    marker.header = clear.header;
    marker.ns = "boxes";
    marker.id = id;
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
    marker.text = instance_name(placement, instance) + percent;
    message.markers.push_back(std::move(marker));
    ++id;
  });
  return message;
}

wire::tf2_msgs::TFMessage transforms_message(const SceneInterpretations& result,
                                             const std::string& prefix) {
  wire::tf2_msgs::TFMessage message;
  for_each_best(result, [&](const Placement& placement, std::uint32_t instance) {
    geometry::TransformStamped transform;
    transform.header = header(result.stamp_ns, result.frame_id);
    transform.child_frame_id = prefix + "/" + instance_name(placement, instance);
    const geometry::Pose pose = pose_message(placement.camera_from_object);
    transform.transform.translation = {pose.position.x, pose.position.y, pose.position.z};
    transform.transform.rotation = pose.orientation;
    message.transforms.push_back(std::move(transform));
  });
  return message;
}

wire::sensor_msgs::Image image_message(const SceneInterpretations& result, int width, int height,
                                       std::vector<std::uint8_t> rgb) {
  wire::sensor_msgs::Image message;
  message.header = header(result.stamp_ns, result.frame_id);
  message.width = static_cast<std::uint32_t>(width);
  message.height = static_cast<std::uint32_t>(height);
  message.encoding = "rgb8";
  message.step = 3 * message.width;
  message.data = std::move(rgb);
  return message;
}

msgs::ModelInfo model_message(const ObjectModel& model) {
  msgs::ModelInfo message;
  message.name = model.name;
  message.number = static_cast<std::uint32_t>(model.number);
  message.diameter = model.diameter;
  const Box box = box_of(model);
  message.box_min = {box.min.x(), box.min.y(), box.min.z()};
  message.box_max = {box.max.x(), box.max.y(), box.max.z()};
  message.point_count = static_cast<std::uint32_t>(model.surface.size());
  for (const Pose& pose : model.symmetry.discrete) {
    message.discrete_symmetries.push_back(pose_message(pose));
  }
  for (const ContinuousSymmetry& symmetry : model.symmetry.continuous) {
    message.continuous_symmetries.push_back(
        {{symmetry.axis.x(), symmetry.axis.y(), symmetry.axis.z()},
         {symmetry.point.x(), symmetry.point.y(), symmetry.point.z()}});
  }
  return message;
}

}  // namespace bpa::server
