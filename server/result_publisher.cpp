// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/result_publisher.hpp"

#include <utility>

#include "core/base/clock.hpp"
#include "core/base/failure.hpp"
#include "server/convert/results.hpp"

namespace bpa::server {

ResultPublisher::ResultPublisher(const wire::Participant& participant, const Settings& settings,
                                 std::shared_ptr<const Recognition> recognition, LogHook log)
    : settings_(settings), recognition_(std::move(recognition)), log_(std::move(log)) {
  tf_prefix_ = participant.node().node_namespace.substr(1);
  if (tf_prefix_.empty()) tf_prefix_ = participant.node().name;
  const OutputOptions options = settings.get()->output;
  const wire::Qos results = wire::qos::results();
  or_throw(interpretations_.open(participant, options.interpretations, results));
  or_throw(detections_.open(participant, options.detections, results));
  or_throw(annotated_.open(participant, options.annotated, results));
  or_throw(markers_.open(participant, options.markers, results));
  or_throw(vision_info_.open(participant, options.vision_info, wire::qos::latched()));
  or_throw(tf_.open(participant, options.tf, wire::qos::transforms()));
}

void ResultPublisher::publish(const Frame* frame, const Result<SceneInterpretations>& result,
                              const ResultContext& context) {
  if (interpretations_.is_open()) {
    interpretations_.send(interpretations_message(result, context), log_);
  }
  if (frame == nullptr || !result.ok()) return;
  const Models models = recognition_->models();
  if (detections_.wanted()) detections_.send(detections_message(*result, models), log_);
  if (markers_.wanted()) {
    const double lifetime_s = settings_.get()->output.marker_lifetime_s;
    markers_.send(markers_message(*result, models, lifetime_s), log_);
  }
  if (tf_.wanted()) tf_.send(transforms_message(*result, tf_prefix_), log_);
  if (!annotated_.wanted()) return;
  const Interpretation best =
      result->interpretations.empty() ? Interpretation() : result->interpretations.front();
  annotated_.send(image_message(*result, frame->camera.width, frame->camera.height,
                                recognition_->annotate(*frame, best)),
                  log_);
}

void ResultPublisher::publish_vision_info() {
  wire::vision_msgs::VisionInfo info;
  info.header.stamp = wire::builtin_interfaces::from_ns(unix_time_ns());
  info.method = "Bingham Procrustean Alignment";
  info.database_location = recognition_->library();
  info.database_version = recognition_->version();
  vision_info_.send(info, log_);
}

}  // namespace bpa::server
