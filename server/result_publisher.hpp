// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "server/output.hpp"
#include "server/recognition.hpp"
#include "server/settings.hpp"

namespace bpa::server {

/// Publishes results. All but the interpretations are made only while they have a subscriber.
class ResultPublisher {
 public:
  /// Opens the topics; `settings` outlives it. Throws a Failure.
  ResultPublisher(const wire::Participant& participant, const Settings& settings,
                  std::shared_ptr<const Recognition> recognition, LogHook log);

  /// `frame` is null when the frame broke a rule; then only the failed interpretations go out.
  void publish(const Frame* frame, const Result<SceneInterpretations>& result,
               const ResultContext& context);
  /// The latched vision_info: again after each change of the library.
  void publish_vision_info();

 private:
  const Settings& settings_;
  const std::shared_ptr<const Recognition> recognition_;
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
