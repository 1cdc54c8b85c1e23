// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/capture/camera_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "idl/wire/time.hpp"
#include "server/capture/bop_source.hpp"
#include "server/capture/openni2_device.hpp"
#include "server/capture/video_mode.hpp"
#include "server/convert/results.hpp"

namespace bpa::server {
namespace {

using Record = wire::bpa_msgs::Record;

constexpr const char* kOpenni2 = "openni2";
constexpr const char* kBop = "bop:";
constexpr double kLongestRecording = 3600;  // seconds

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool is_recording(const std::string& source) { return ends_with(source, ".oni"); }

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
  if (!ends_with(request.path, ".oni")) {
    return invalid_argument("path is \"" + request.path + "\"; it must end with .oni");
  }
  if (request.seconds > 0 && request.seconds <= kLongestRecording) return {};
  return invalid_argument("seconds is " + std::to_string(request.seconds) +
                          "; it must be more than 0 and at most 3600");
}

void handle(Capture& capture, const Record::Request& request, const wire::ReplyToken<Record>& token,
            const LogHook& hook) {
  const auto reply = [token, hook](const Result<RecordingSummary>& result) {
    const Status sent = token.reply(response_of(result));
    if (!sent.ok()) log(hook, LogLevel::info, "record: " + sent.message);
  };
  if (request.stop) {
    capture.stop_recording(reply);
  } else if (const Status status = check_record(request); !status.ok()) {
    reply(status);
  } else {
    const auto limit = std::chrono::milliseconds(std::llround(1000 * request.seconds));
    capture.start_recording(request.path, limit, reply);
  }
}

}  // namespace

Status check_capture(const CaptureOptions& options) {
  const std::string& source = options.source;
  if (!source.empty() && source != kOpenni2 && source.rfind("openni2:", 0) != 0 &&
      source.rfind(kBop, 0) != 0 && !is_recording(source)) {
    return invalid_argument("capture.source is \"" + source +
                            "\"; it must be openni2, openni2:URI, a FILE.oni, bop:FOLDER or empty");
  }
  for (const auto& [field, mode] : {std::pair("capture.depth_mode", options.depth_mode),
                                    std::pair("capture.color_mode", options.color_mode)}) {
    if (parse_video_mode(mode)) continue;
    return invalid_argument(std::string(field) + " is \"" + mode + "\"; it must read 640x480@30");
  }
  for (const char* choice : {"auto", "device", "software", "off"}) {
    if (options.registration == choice) return {};
  }
  return invalid_argument("capture.registration is \"" + options.registration +
                          "\"; it must be one of auto, device, software, off");
}

Result<OpenCamera> camera_of(const CaptureOptions& options, const LogHook& log) {
  const std::string& source = options.source;
  if (source.rfind(kBop, 0) == 0) {
    const std::string folder = source.substr(std::string(kBop).size());
    return OpenCamera([folder, options] { return open_bop_source(folder, options); });
  }
  if (is_recording(source)) return openni2_camera({source, true}, options, log);
  if (source == kOpenni2) return openni2_camera({"", false}, options, log);
  if (source.rfind("openni2:", 0) == 0) {
    return openni2_camera({source.substr(std::string("openni2:").size()), false}, options, log);
  }
  return invalid_argument("capture.source names no camera");
}

Result<std::unique_ptr<CameraSource>> CameraSource::create(
    const wire::Participant& participant, const CaptureOptions& options,
    std::function<void(IncomingFrame&&)> on_frame, std::function<bool()> idle, LogHook log) {
  auto open = camera_of(options, log);
  if (!open.ok()) return open.status();
  auto publisher = CameraPublisher::create(participant, options, log);
  if (!publisher.ok()) return publisher.status();
  std::unique_ptr<CameraSource> self(new CameraSource());
  self->publisher_ = std::move(publisher).value();
  CaptureTimes times;
  times.timeout = std::chrono::milliseconds(static_cast<int>(options.timeout_ms));
  times.retry = std::chrono::milliseconds(static_cast<int>(options.retry_ms));
  const bool paced =
      options.every_frame && (is_recording(options.source) || options.source.rfind(kBop, 0) == 0);
  if (!paced) idle = nullptr;
  self->capture_ = std::make_unique<Capture>(
      std::move(open).value(), times,
      [publisher_of = self->publisher_.get(), on_frame = std::move(on_frame),
       search = options.search](const CameraImages& images) {
        publisher_of->publish(images);
        if (search) on_frame(incoming(images));
      },
      std::move(idle), log);
  if (Status status = self->offer_record(participant, log); !status.ok()) return status;
  return self;
}

Status CameraSource::offer_record(const wire::Participant& participant, LogHook log) {
  auto server = wire::ServiceServer<Record>::create(
      participant, "record",
      [capture = capture_.get(), log = std::move(log)](Record::Request&& request,
                                                       wire::ReplyToken<Record> token) {
        handle(*capture, request, token, log);
      });
  if (!server.ok()) return server.status();
  record_.emplace(std::move(server).value());
  return {};
}

std::vector<SourceReport> CameraSource::reports() const {
  const CaptureStatus status = capture_->status();
  SourceReport report;
  report.name = "capture";
  report.hardware_id = status.device.empty() ? "none" : status.device;
  report.level = status.level;
  report.message = status.text;
  report.values = {{"capture: sets of images", std::to_string(status.frames)},
                   {"capture: device opened", std::to_string(status.opened)},
                   {"capture: last attempt to open", status.last_attempt},
                   {"capture: recording", status.recording},
                   {"capture: sets not published", std::to_string(publisher_->dropped())}};
  return {report};
}

}  // namespace bpa::server
