// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <filesystem>
#include <utility>

#include "camera/capture.hpp"
#include "camera/open_camera.hpp"
#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/task_thread.hpp"
#include "idl/wire/time.hpp"
#include "server/convert/results.hpp"
#include "server/options.hpp"
#include "server/output.hpp"
#include "server/search_queue.hpp"
#include "server/services/services.hpp"
#include "server/sources/frame_source.hpp"
#include "server/tf_buffer.hpp"

namespace bpa::server {
namespace {

using Record = wire::bpa_msgs::Record;
using camera::RecordingSummary;
using std::chrono::milliseconds;

constexpr double kLongestRecording = 3600;  // seconds

/// Publishes the images of the server's own camera as a ROS 2 camera driver does. It sends on a
/// thread of its own: a slow subscriber costs images, not the capture's time.
class CameraPublisher {
 public:
  /// Throws a Failure.
  CameraPublisher(const wire::Participant& participant, const CaptureOptions& options, LogHook log)
      : log_(std::move(log)), sender_(log_, 1) {
    const wire::Qos qos = wire::qos::frames();
    color_.open(participant, options.color_topic, qos);
    depth_.open(participant, options.depth_topic, qos);
    color_info_.open(participant, options.color_info_topic, qos);
    depth_info_.open(participant, options.depth_info_topic, qos);
    points_.open(participant, options.points_topic, qos);
  }

  /// Takes the images to publish; those that wait give way to them.
  void publish(const ros::CameraImages& images) {
    if (!color_.wanted() && !depth_.wanted() && !color_info_.wanted() && !depth_info_.wanted() &&
        !points_.wanted()) {
      return;
    }
    const auto now = wire::TaskThread::Clock::now();
    if (!sender_.run_at(now, [this, images] { send(images); })) ++dropped_;
  }
  /// Sets of images that gave way to newer ones.
  std::uint64_t dropped() const { return dropped_; }

 private:
  void send(const ros::CameraImages& images) {
    const auto send_to = [this](auto& output, const auto* message) {
      if (message != nullptr && output.wanted()) output.send(*message, log_, LogLevel::debug);
    };
    send_to(color_info_, images.info.get());
    send_to(depth_info_, images.info.get());
    send_to(depth_, std::get_if<wire::sensor_msgs::Image>(images.depth.get()));
    send_to(color_, std::get_if<wire::sensor_msgs::Image>(images.color.get()));
    if (!points_.wanted()) return;
    const auto frame = ros::frame_from_images(images, false);
    if (frame.ok()) points_.send(cloud_message(*frame), log_, LogLevel::debug);
  }

  const LogHook log_;
  Output<wire::sensor_msgs::Image> color_, depth_;
  Output<wire::sensor_msgs::CameraInfo> color_info_, depth_info_;
  Output<wire::sensor_msgs::PointCloud2> points_;
  std::atomic<std::uint64_t> dropped_{0};
  wire::TaskThread sender_;  ///< Last: ends while all else is there.
};

IncomingFrame incoming(const ros::CameraImages& images) {
  const wire::std_msgs::Header& header = ros::header_of(*images.depth);
  return {[images] { return ros::frame_from_images(images, false); }, to_ns(header.stamp),
          header.frame_id};
}

/// `busy`, `unavailable` and so on as the response of the service.
Record::Response response_of(const Result<RecordingSummary>& result) {
  const auto [path, frames, bytes] = result.ok() ? *result : RecordingSummary();
  return {result.ok(), to_message(result.status()), path, frames, bytes};
}

/// The file that a request means.
Result<std::string> file_of(const Record::Request& request, const std::string& folder) {
  if (folder.empty()) {
    return Status(StatusCode::unsupported,
                  "recording is switched off: capture.record_folder names no folder");
  }
  if (!(request.seconds > 0 && request.seconds <= kLongestRecording)) {
    return invalid_argument("seconds is " + std::to_string(request.seconds) +
                            "; it must be more than 0 and at most 3600");
  }
  if (!request.path.ends_with(".oni")) {
    return invalid_argument("path is \"" + request.path + "\"; it must end with .oni");
  }
  return io::path_below(folder, request.path);
}

/// What recordings may still take of their quota.
Result<std::uint64_t> bytes_left(const CaptureOptions& options) {
  namespace fs = std::filesystem;
  const auto quota = static_cast<std::uint64_t>(options.record_max_mb * 1e6);
  std::uint64_t used = 0;
  std::error_code error;
  fs::recursive_directory_iterator entry(options.record_folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    const auto bytes = entry->is_regular_file(gone) ? entry->file_size(gone) : 0;
    if (!gone) used += bytes;
  }
  if (error) return unavailable(options.record_folder, ": ", error.message());
  if (used < quota) return quota - used;
  return unavailable("the files in ", options.record_folder, " have ", used / 1'000'000,
                     " MB; recordings may take ", quota / 1'000'000, " (capture.record_max_mb)");
}

void handle(const CaptureOptions& options, camera::Capture& capture, const Record::Request& request,
            const Answer<Record>& send) {
  const auto answer = [send](const Result<RecordingSummary>& result) { send(response_of(result)); };
  if (request.stop) return capture.stop_recording(answer);
  const Result<std::string> path = file_of(request, options.record_folder);
  if (!path.ok()) return answer(path.status());
  const Result<std::uint64_t> bytes = bytes_left(options);
  if (!bytes.ok()) return answer(bytes.status());
  const auto time = milliseconds(std::llround(1000 * request.seconds));
  capture.start_recording(*path, {time, *bytes}, answer);
}

std::byte level_of(LogLevel level) {
  if (level == LogLevel::error) return SourceReport::kError;
  return level == LogLevel::warning ? SourceReport::kWarn : SourceReport::kOk;
}

class CameraSource : public FrameSource {
 public:
  /// As open_camera_source().
  CameraSource(const wire::Participant& participant, const CaptureOptions& options,
               OnFrame on_frame, std::function<bool()> idle, TfBuffer& transforms, LogHook log)
      : options_(options),
        publisher_(participant, options, log),
        capture_(
            or_throw(camera::camera_of(options, log,
                                       [&transforms](const auto& message, bool is_static) {
                                         for (const auto& one : message.transforms)
                                           transforms.add(one, is_static);
                                       })),
            {milliseconds(static_cast<int>(options.timeout_ms)),
             milliseconds(static_cast<int>(options.retry_ms))},
            [this, on_frame = std::move(on_frame), frame_id = options.frame_id,
             search = options.search](camera::SensorImages&& images) {
              const std::string frame = images.frame_id.empty() ? frame_id : images.frame_id;
              const ros::CameraImages messages = image_messages(std::move(images), frame);
              publisher_.publish(messages);
              if (search) on_frame(incoming(messages));
            },
            camera::is_paced(options) ? std::move(idle) : nullptr, log),
        services_(participant, std::move(log)) {
    services_.add<Record>(
        "record", [this](const Record::Request& request, const Reply<Record>& reply) {
          record(request, [reply](const Record::Response& response) { reply.send(response); });
        });
  }

  void record(const Record::Request& request, const Answer<Record>& answer) override {
    handle(options_, capture_, request, answer);
  }

  RequestLosses losses() const override { return services_.losses(); }
  std::vector<const Busy*> threads() const override { return {&services_.busy()}; }

  std::vector<SourceReport> reports() const override {
    const camera::CaptureStatus status = capture_.status();
    return {{level_of(status.level),
             "capture",
             status.text,
             status.device.empty() ? "none" : status.device,
             {{"capture: sets of images", std::to_string(status.frames)},
              {"capture: device opened", std::to_string(status.opened)},
              {"capture: last attempt to open", status.last_attempt},
              {"capture: recording", status.recording},
              {"capture: sets not published", std::to_string(publisher_.dropped())}}}};
  }

 private:
  const CaptureOptions options_;
  // Destroyed from the last to the first: nothing calls into what is gone.
  CameraPublisher publisher_;
  camera::Capture capture_;
  ServiceSet services_;
};

}  // namespace

void FrameSource::record(const Record::Request&, const Answer<Record>& answer) {
  answer(response_of(Status(StatusCode::unsupported,
                            "the server has no camera of its own to record (capture.source)")));
}

std::unique_ptr<FrameSource> open_camera_source(const wire::Participant& participant,
                                                const CaptureOptions& options, OnFrame on_frame,
                                                std::function<bool()> idle, TfBuffer& transforms,
                                                LogHook log) {
  return std::make_unique<CameraSource>(participant, options, std::move(on_frame), std::move(idle),
                                        transforms, std::move(log));
}

}  // namespace bpa::server
