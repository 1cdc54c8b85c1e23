// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/camera_source.hpp"

#include <cmath>
#include <utility>

#include "camera/open_camera.hpp"
#include "idl/wire/time.hpp"
#include "server/convert/results.hpp"
#include "server/sources/image_messages.hpp"

namespace bpa::server {
namespace {

using Record = wire::bpa_msgs::Record;
using camera::RecordingSummary;

constexpr double kLongestRecording = 3600;  // seconds

IncomingFrame incoming(const CameraImages& images) {
  const wire::std_msgs::Header& header = header_of(*images.depth);
  return {[images] { return frame_from_images(images, false); }, to_ns(header.stamp),
          header.frame_id};
}

/// `busy`, `unavailable` and so on as the response of the service.
Record::Response response_of(const Result<RecordingSummary>& result) {
  Record::Response response;
  response.success = result.ok();
  response.status = to_message(result.status());
  if (result.ok()) {
    response.path = result->path;
    response.frames = result->frames;
    response.bytes = result->bytes;
  }
  return response;
}

Status check_record(const Record::Request& request) {
  if (request.path.empty() || request.path.front() != '/') {
    return invalid_argument("path is \"" + request.path +
                            "\"; it must begin with / and is of the server's machine");
  }
  if (!request.path.ends_with(".oni")) {
    return invalid_argument("path is \"" + request.path + "\"; it must end with .oni");
  }
  if (request.seconds > 0 && request.seconds <= kLongestRecording) return {};
  return invalid_argument("seconds is " + std::to_string(request.seconds) +
                          "; it must be more than 0 and at most 3600");
}

void handle(camera::Capture& capture, const Record::Request& request, const Reply<Record>& reply) {
  const auto answer = [reply](const Result<RecordingSummary>& result) {
    reply.send(response_of(result));
  };
  if (request.stop) {
    capture.stop_recording(answer);
  } else if (const Status status = check_record(request); !status.ok()) {
    answer(status);
  } else {
    const auto limit = std::chrono::milliseconds(std::llround(1000 * request.seconds));
    capture.start_recording(request.path, limit, answer);
  }
}

std::byte level_of(LogLevel level) {
  if (level == LogLevel::error) return SourceReport::kError;
  return level == LogLevel::warning ? SourceReport::kWarn : SourceReport::kOk;
}

}  // namespace

Result<std::unique_ptr<CameraSource>> CameraSource::create(
    const wire::Participant& participant, const CaptureOptions& options,
    std::function<void(IncomingFrame&&)> on_frame, std::function<bool()> idle, LogHook log) {
  auto open = camera::camera_of(options, log);
  if (!open.ok()) return open.status();
  auto publisher = CameraPublisher::create(participant, options, log);
  if (!publisher.ok()) return publisher.status();
  std::unique_ptr<CameraSource> self(new CameraSource());
  self->publisher_ = std::move(publisher).value();
  camera::CaptureTimes times;
  times.timeout = std::chrono::milliseconds(static_cast<int>(options.timeout_ms));
  times.retry = std::chrono::milliseconds(static_cast<int>(options.retry_ms));
  if (!camera::is_paced(options)) idle = nullptr;
  self->capture_ = std::make_unique<camera::Capture>(
      std::move(open).value(), times,
      [publisher = self->publisher_.get(), on_frame = std::move(on_frame),
       frame_id = options.frame_id, search = options.search](camera::SensorImages&& images) {
        const CameraImages messages = image_messages(std::move(images), frame_id);
        publisher->publish(messages);
        if (search) on_frame(incoming(messages));
      },
      std::move(idle), log);
  self->services_.emplace(participant, std::move(log));
  const Status offered = self->services_->add<Record>(
      "record",
      [capture = self->capture_.get()](const Record::Request& request, const Reply<Record>& reply) {
        handle(*capture, request, reply);
      });
  if (!offered.ok()) return offered;
  return self;
}

std::vector<SourceReport> CameraSource::reports() const {
  const camera::CaptureStatus status = capture_->status();
  SourceReport report;
  report.name = "capture";
  report.hardware_id = status.device.empty() ? "none" : status.device;
  report.level = level_of(status.level);
  report.message = status.text;
  report.values = {{"capture: sets of images", std::to_string(status.frames)},
                   {"capture: device opened", std::to_string(status.opened)},
                   {"capture: last attempt to open", status.last_attempt},
                   {"capture: recording", status.recording},
                   {"capture: sets not published", std::to_string(publisher_->dropped())}};
  return {report};
}

}  // namespace bpa::server
