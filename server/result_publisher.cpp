// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/result_publisher.hpp"

#include <utility>

#include "core/base/clock.hpp"
#include "server/convert/results.hpp"

namespace bpa::server {
namespace {

template <class T>
Status open(const wire::Participant& participant, const std::string& topic, const wire::Qos& qos,
            std::optional<wire::Publisher<T>>& place) {
  if (topic.empty()) return {};
  wire::PublisherOptions options;
  options.qos = qos;
  auto publisher = wire::Publisher<T>::create(participant, topic, options);
  if (!publisher.ok()) return publisher.status();
  place.emplace(std::move(publisher).value());
  return {};
}

template <class T>
bool wanted(const std::optional<wire::Publisher<T>>& output) {
  return output && output->matched_count() > 0;
}

template <class T, class Message>
void send(std::optional<wire::Publisher<T>>& output, const Message& message, const LogHook& hook) {
  const Status status = output->publish(message);
  if (!status.ok()) log(hook, LogLevel::warning, output->topic() + ": " + status.message);
}

}  // namespace

Result<std::unique_ptr<ResultPublisher>> ResultPublisher::create(
    const wire::Participant& participant, const Settings& settings,
    std::shared_ptr<const Recognition> recognition, LogHook log) {
  const OutputOptions options = settings.get()->output;
  std::unique_ptr<ResultPublisher> self(
      new ResultPublisher(settings, std::move(recognition), std::move(log)));
  self->tf_prefix_ = participant.node().node_namespace.substr(1);
  if (self->tf_prefix_.empty()) self->tf_prefix_ = participant.node().name;
  const wire::Qos results = wire::qos::results();
  for (const Status& status :
       {open(participant, options.interpretations, results, self->interpretations_),
        open(participant, options.detections, results, self->detections_),
        open(participant, options.annotated, results, self->annotated_),
        open(participant, options.markers, results, self->markers_),
        open(participant, options.vision_info, wire::qos::latched(), self->vision_info_),
        open(participant, options.tf, wire::qos::transforms(), self->tf_),
        open(participant, options.diagnostics, results, self->diagnostics_)}) {
    if (!status.ok()) return status;
  }
  return self;
}

void ResultPublisher::publish(const Frame* frame, const Result<SceneInterpretations>& result,
                              const ResultContext& context) {
  if (interpretations_) send(interpretations_, interpretations_message(result, context), log_);
  if (frame == nullptr || !result.ok()) return;
  const Models models = recognition_->models();
  if (wanted(detections_)) send(detections_, detections_message(*result, models), log_);
  if (wanted(markers_)) {
    const double lifetime_s = settings_.get()->output.marker_lifetime_s;
    send(markers_, markers_message(*result, models, lifetime_s), log_);
  }
  if (wanted(tf_)) send(tf_, transforms_message(*result, tf_prefix_), log_);
  if (wanted(annotated_)) publish_annotated(*frame, *result);
}

void ResultPublisher::publish_annotated(const Frame& frame, const SceneInterpretations& result) {
  const Interpretation none;
  const Interpretation& best =
      result.interpretations.empty() ? none : result.interpretations.front();
  send(annotated_,
       image_message(result, frame.camera.width, frame.camera.height,
                     recognition_->annotate(frame, best)),
       log_);
}

void ResultPublisher::publish_vision_info() {
  if (!vision_info_) return;
  wire::vision_msgs::VisionInfo info;
  info.header.stamp = wire::builtin_interfaces::from_ns(unix_time_ns());
  info.method = "Bingham Procrustean Alignment";
  info.database_location = recognition_->library();
  info.database_version = recognition_->version();
  send(vision_info_, info, log_);
}

void ResultPublisher::publish(const wire::diagnostic_msgs::DiagnosticArray& diagnostics) {
  if (diagnostics_) send(diagnostics_, diagnostics, log_);
}

bool ResultPublisher::diagnostics_wanted() const { return wanted(diagnostics_); }

}  // namespace bpa::server
