// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "camera/capture.hpp"
#include "camera/open_camera.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/time.hpp"
#include "server/convert/results.hpp"
#include "server/options.hpp"
#include "server/output.hpp"
#include "server/services/services.hpp"
#include "server/sources/camera_messages.hpp"
#include "server/sources/frame_source.hpp"
#include "server/worker.hpp"

namespace bpa::server {
namespace {

using Record = wire::bpa_msgs::Record;
using camera::RecordingSummary;

constexpr double kLongestRecording = 3600;  // seconds

/// Publishes the images of the server's own camera as a ROS 2 camera driver does. It sends on a
/// thread of its own: a slow subscriber costs images, not the capture's time.
class CameraPublisher {
 public:
  Status open(const wire::Participant& participant, const CaptureOptions& options, LogHook log) {
    log_ = std::move(log);
    const wire::Qos qos = wire::qos::frames();
    for (const Status& status : {color_.open(participant, options.color_topic, qos),
                                 depth_.open(participant, options.depth_topic, qos),
                                 color_info_.open(participant, options.color_info_topic, qos),
                                 depth_info_.open(participant, options.depth_info_topic, qos),
                                 points_.open(participant, options.points_topic, qos)}) {
      if (!status.ok()) return status;
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    return {};
  }

  /// Takes the images to publish; those that wait give way to them.
  void publish(const CameraImages& images) {
    if (!color_.wanted() && !depth_.wanted() && !color_info_.wanted() && !depth_info_.wanted() &&
        !points_.wanted()) {
      return;
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (next_) ++dropped_;
      next_ = images;
    }
    wake_.notify_one();
  }
  /// Sets of images that gave way to newer ones.
  std::uint64_t dropped() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return dropped_;
  }

 private:
  void run(const std::stop_token& stop) {
    std::unique_lock<std::mutex> lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return next_.has_value(); })) {
      const CameraImages images = *std::exchange(next_, std::nullopt);
      lock.unlock();
      send(images);
      lock.lock();
    }
  }

  void send(const CameraImages& images) {
    const auto send_to = [this](auto& output, const auto* message) {
      if (message != nullptr && output.wanted()) output.send(*message, log_, LogLevel::debug);
    };
    send_to(color_info_, images.info.get());
    send_to(depth_info_, images.info.get());
    send_to(depth_, std::get_if<wire::sensor_msgs::Image>(images.depth.get()));
    send_to(color_, std::get_if<wire::sensor_msgs::Image>(images.color.get()));
    if (!points_.wanted()) return;
    const auto frame = frame_from_images(images, false);
    if (frame.ok()) points_.send(cloud_message(*frame), log_, LogLevel::debug);
  }

  LogHook log_;
  Output<wire::sensor_msgs::Image> color_, depth_;
  Output<wire::sensor_msgs::CameraInfo> color_info_, depth_info_;
  Output<wire::sensor_msgs::PointCloud2> points_;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<CameraImages> next_;
  std::uint64_t dropped_ = 0;
  std::jthread thread_;  ///< Last: ends while all else is there.
};

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

struct CameraSource : FrameSource {
  std::vector<SourceReport> reports() const override {
    const camera::CaptureStatus status = capture->status();
    SourceReport report;
    report.name = "capture";
    report.hardware_id = status.device.empty() ? "none" : status.device;
    report.level = level_of(status.level);
    report.message = status.text;
    report.values = {{"capture: sets of images", std::to_string(status.frames)},
                     {"capture: device opened", std::to_string(status.opened)},
                     {"capture: last attempt to open", status.last_attempt},
                     {"capture: recording", status.recording},
                     {"capture: sets not published", std::to_string(publisher.dropped())}};
    return {report};
  }

  // Destroyed from the last to the first: nothing calls into what is gone.
  CameraPublisher publisher;
  std::optional<camera::Capture> capture;
  std::optional<ServiceSet> services;
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_camera_source(const wire::Participant& participant,
                                                        const CaptureOptions& options,
                                                        OnFrame on_frame,
                                                        std::function<bool()> idle, LogHook log) {
  auto open = camera::camera_of(options, log);
  if (!open.ok()) return open.status();
  auto source = std::make_unique<CameraSource>();
  const Status opened = source->publisher.open(participant, options, log);
  if (!opened.ok()) return opened;
  const camera::CaptureTimes times{std::chrono::milliseconds(static_cast<int>(options.timeout_ms)),
                                   std::chrono::milliseconds(static_cast<int>(options.retry_ms))};
  if (!camera::is_paced(options)) idle = nullptr;
  source->capture.emplace(
      std::move(open).value(), times,
      [&publisher = source->publisher, on_frame = std::move(on_frame), frame_id = options.frame_id,
       search = options.search](camera::SensorImages&& images) {
        const CameraImages messages = image_messages(std::move(images), frame_id);
        publisher.publish(messages);
        if (search) on_frame(incoming(messages));
      },
      std::move(idle), log);
  source->services.emplace(participant, std::move(log));
  const Status offered = source->services->add<Record>(
      "record",
      [&capture = *source->capture](const Record::Request& request, const Reply<Record>& reply) {
        handle(capture, request, reply);
      });
  if (!offered.ok()) return offered;
  return std::unique_ptr<FrameSource>(std::move(source));
}

}  // namespace bpa::server
