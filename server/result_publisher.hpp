// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "core/cloud/frame.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/time.hpp"
#include "server/convert/results.hpp"
#include "server/output.hpp"
#include "server/recognition.hpp"
#include "server/settings.hpp"
#include "server/sources/transform_source.hpp"

namespace bpa::server {

/// Publishes results. All but the interpretations are made only while they have a subscriber.
class ResultPublisher {
 public:
  /// Opens the topics; `settings` outlives it. Throws a Failure.
  ResultPublisher(const wire::Participant& participant, const Settings& settings,
                  std::shared_ptr<const Recognition> recognition,
                  std::shared_ptr<const WaitableClock> clock, LogHook log)
      : settings_(settings),
        recognition_(std::move(recognition)),
        clock_(std::move(clock)),
        log_(std::move(log)) {
    tf_prefix_ = participant.node().node_namespace.substr(1);
    if (tf_prefix_.empty()) tf_prefix_ = participant.node().name;
    const Settings::Snapshot all = settings.get();
    const OutputOptions& options = all->output;
    const wire::Qos results = wire::qos::results();
    interpretations_.open(participant, options.interpretations, results);
    detections_.open(participant, options.detections, results);
    annotated_.open(participant, options.annotated, results);
    markers_.open(participant, options.markers, results);
    vision_info_.open(participant, options.vision_info, wire::qos::latched());
    tf_.open(participant, options.tf, wire::qos::transforms(),
             own_transform_readers(participant, *all));
  }

  /// Whether a result of a search has a reader. /vision_info is none.
  bool wanted() const {
    return interpretations_.wanted() || detections_.wanted() || annotated_.wanted() ||
           markers_.wanted() || tf_.wanted();
  }

  /// `frame` is null when the frame broke a rule, and for several views: then no picture goes out.
  void publish(const Frame* frame, const Result<SceneInterpretations>& result,
               const ResultContext& context) {
    if (interpretations_.is_open()) {
      interpretations_.send(interpretations_message(result, context), log_);
    }
    if (!result.ok()) return;
    const Models models = recognition_->models();
    if (detections_.wanted()) detections_.send(detections_message(*result, models), log_);
    if (markers_.wanted()) {
      const double lifetime_s = settings_.get()->output.marker_lifetime_s;
      markers_.send(markers_message(*result, models, lifetime_s), log_);
    }
    if (tf_.wanted()) tf_.send(transforms_message(*result, tf_prefix_), log_);
    if (frame == nullptr || !annotated_.wanted()) return;
    const Interpretation best =
        result->interpretations.empty() ? Interpretation() : result->interpretations.front();
    annotated_.send(image_message(*result, frame->camera.width, frame->camera.height,
                                  recognition_->annotate(*frame, best)),
                    log_);
  }

  /// The latched vision_info: again after each change of the library.
  void publish_vision_info() {
    wire::vision_msgs::VisionInfo info;
    info.header.stamp = wire::builtin_interfaces::from_ns(clock_->stamp_ns());
    info.method = "Bingham Procrustean Alignment";
    info.database_location = recognition_->library();
    info.database_version = recognition_->version();
    vision_info_.send(info, log_);
  }

 private:
  const Settings& settings_;
  const std::shared_ptr<const Recognition> recognition_;
  const std::shared_ptr<const WaitableClock> clock_;
  const LogHook log_;
  std::string tf_prefix_;
  Output<wire::bpa_msgs::SceneInterpretations> interpretations_;
  Output<wire::vision_msgs::Detection3DArray> detections_;
  Output<wire::sensor_msgs::Image> annotated_;
  Output<wire::visualization_msgs::MarkerArray> markers_;
  Output<wire::vision_msgs::VisionInfo> vision_info_;
  Output<wire::tf2_msgs::TFMessage> tf_;
};

}  // namespace bpa::server
