// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/results.hpp"

#include <cstdio>
#include <map>
#include <utility>

#include "server/convert/parts.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;
namespace geometry = wire::geometry_msgs;
namespace vision = wire::vision_msgs;
namespace markers = wire::visualization_msgs;

msgs::Placement placement_message(const Placement& placement, std::uint32_t instance) {
  msgs::Placement message{.model = placement.model,
                          .model_number = static_cast<std::uint32_t>(placement.model_number),
                          .instance = instance,
                          .pose = pose_message(placement.frame_from_object, placement.covariance),
                          .orientation = bingham_message(placement.orientation),
                          .score = placement.score,
                          .probability = placement.probability,
                          .presence = placement.presence,
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

}  // namespace

Eigen::AlignedBox3d box_of(const ObjectModel& model) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : model.surface.points) box.extend(point);
  if (box.isEmpty()) box.extend(Eigen::Vector3f::Zero().eval());
  return box.cast<double>();
}

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
  message.header = header_message(context.stamp_ns, context.frame_id);
  message.status = to_message(result.status());
  message.models_searched = static_cast<std::uint32_t>(context.models_searched);
  message.seed = context.seed;
  if (!result.ok()) return message;
  message.status.message = context.advice;
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
  if (!result->not_searched.empty()) {
    message.models_searched -= static_cast<std::uint32_t>(result->not_searched.size());
    message.status.message = "not searched for, as the search was lost with its worker: ";
    const char* separator = "";
    for (const std::string& name : result->not_searched) {
      message.status.message += std::exchange(separator, ", ") + name;
    }
  }
  for (const MissedModel& missed : result->missed) {
    message.missed.push_back({missed.model, missed.expected});
  }
  message.fused_frames = static_cast<std::uint32_t>(result->fused_frames);
  return message;
}

vision::Detection3DArray detections_message(const SceneInterpretations& result,
                                            const Models& models) {
  vision::Detection3DArray message;
  message.header = header_message(result.stamp_ns, result.frame_id);
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    message.detections.push_back(
        {message.header,
         {{{placement.model, placement.presence},
           pose_message(placement.frame_from_object, placement.covariance)}},
         box_message(placement.frame_from_object, placement.model_number, models),
         name});
  });
  return message;
}

markers::MarkerArray markers_message(const SceneInterpretations& result, const Models& models,
                                     double lifetime_s) {
  markers::MarkerArray message;
  const wire::std_msgs::Header header = header_message(result.stamp_ns, result.frame_id);
  message.markers.push_back(clearing_marker(header));
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    char percent[16];
    std::snprintf(percent, sizeof percent, " %.0f %%", 100 * placement.presence);
    const auto id = static_cast<std::int32_t>(message.markers.size() / 2);
    add_markers(header,
                {id, box_message(placement.frame_from_object, placement.model_number, models),
                 placement.model_number, name + percent},
                lifetime_s, message);
  });
  return message;
}

wire::tf2_msgs::TFMessage transforms_message(const SceneInterpretations& result,
                                             const std::string& prefix) {
  wire::tf2_msgs::TFMessage message;
  for_each_best(result, [&](const Placement& placement, const std::string& name) {
    message.transforms.push_back({header_message(result.stamp_ns, result.frame_id),
                                  prefix + "/" + name,
                                  transform_message(placement.frame_from_object)});
  });
  return message;
}

wire::sensor_msgs::Image image_message(const SceneInterpretations& result, int width, int height,
                                       std::vector<std::uint8_t> rgb) {
  return {.header = header_message(result.stamp_ns, result.frame_id),
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
