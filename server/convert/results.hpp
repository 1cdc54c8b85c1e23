// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/msg/tf2_msgs.hpp"
#include "idl/wire/msg/vision_msgs.hpp"
#include "idl/wire/msg/visualization_msgs.hpp"

// What the core found -> messages. Stamp and frame_id are always those of the frame.

namespace bpa::server {

/// What a frame's result is about.
struct ResultContext {
  std::int64_t stamp_ns = 0;
  std::string frame_id;
  int models_searched = 0;
  std::uint64_t seed = 0;
  std::string advice = {};  ///< Of the doctor, where little is found.
};

wire::bpa_msgs::Status to_message(const Status& status);
std::vector<wire::bpa_msgs::StageTiming> to_message(const std::vector<StageTiming>& timings);

/// All interpretations; `status` not ok and none when the frame could not be searched.
wire::bpa_msgs::SceneInterpretations interpretations_message(
    const Result<SceneInterpretations>& result, const ResultContext& context);

/// The placements of the best interpretation: class_id is the model's name, score the probability,
/// bbox the box along the model's axes, id "NAME_INSTANCE".
wire::vision_msgs::Detection3DArray detections_message(const SceneInterpretations& result,
                                                       const Models& models);

/// One box and one name per placement of the best interpretation, after a marker that deletes the
/// last frame's. The colour follows the model's number; `lifetime_s` 0 is for ever.
wire::visualization_msgs::MarkerArray markers_message(const SceneInterpretations& result,
                                                      const Models& models, double lifetime_s);

/// A transform per placement of the best interpretation, child frame "PREFIX/NAME_INSTANCE".
wire::tf2_msgs::TFMessage transforms_message(const SceneInterpretations& result,
                                             const std::string& prefix);

/// An rgb8 image of `width` x `height`.
wire::sensor_msgs::Image image_message(const SceneInterpretations& result, int width, int height,
                                       std::vector<std::uint8_t> rgb);

/// The box of a model's surface along its axes; a point for a model without surface.
Eigen::AlignedBox3d box_of(const ObjectModel& model);

wire::bpa_msgs::ModelInfo model_message(const ObjectModel& model);

}  // namespace bpa::server
