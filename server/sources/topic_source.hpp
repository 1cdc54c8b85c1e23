// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/options.hpp"
#include "server/sources/frame_source.hpp"
#include "server/sources/synchronizer.hpp"
#include "server/worker.hpp"

namespace bpa::server {

/// Takes frames from topics: whole ones (bpa_msgs/RgbdFrame), organised clouds, and the images of a
/// ROS 2 camera, put together by their stamps. DDS threads only sort messages; decoding them is
/// left to whoever takes the IncomingFrame.
class TopicSource : public FrameSource {
 public:
  using OnFrame = std::function<void(IncomingFrame&&)>;

  /// Subscribes to what the options name. `on_frame` runs on DDS threads.
  static Result<std::unique_ptr<TopicSource>> create(const wire::Participant& participant,
                                                     const ServerOptions& options, OnFrame on_frame,
                                                     LogHook log);

  /// Takes over what may change at run time: rectified, sync_tolerance_ms, sync_queue, silence_s.
  void set_options(const InputOptions& options);

  std::vector<SourceReport> reports() const override;
  /// Publishers of the topic of whole frames that are matched now; 0 without that topic.
  std::size_t frame_publishers() const { return frames_ ? frames_->matched_count() : 0; }
  /// What became of the camera's messages.
  SyncCounts sync_counts() const;

 private:
  /// When a topic last brought something.
  class Pulse {
   public:
    void beat() { last_ns_ = now(); }
    /// Seconds; nothing before the first message.
    std::optional<double> silence() const;

   private:
    static std::int64_t now() {
      return std::chrono::steady_clock::now().time_since_epoch().count();
    }
    std::atomic<std::int64_t> last_ns_{0};
  };

  /// A subscription to images, raw or compressed.
  struct ImageTopic {
    std::optional<wire::Subscriber<wire::sensor_msgs::Image>> raw;
    std::optional<wire::Subscriber<wire::sensor_msgs::CompressedImage>> compressed;
    Pulse pulse;

    bool open() const { return raw || compressed; }
    const std::string& topic() const { return raw ? raw->topic() : compressed->topic(); }
    std::size_t publishers() const;
    wire::ReaderStatistics statistics() const;
  };

  TopicSource(const InputOptions& options, OnFrame on_frame, LogHook log);
  Status subscribe(const wire::Participant& participant, const ServerOptions& options);
  Status subscribe_frames(const wire::Participant& participant, std::size_t shared_bytes);
  Status subscribe_cloud(const wire::Participant& participant);
  Status subscribe_camera(const wire::Participant& participant);
  Status subscribe_images(const wire::Participant& participant, const std::string& topic,
                          const std::string& transport, void (Synchronizer::*add)(AnyImage&&),
                          ImageTopic& place);
  wire::SubscriberOptions camera_subscription() const;
  void deliver_complete(std::unique_lock<std::mutex> lock);
  SourceReport whole_report(const char* name, const std::string& topic, std::size_t publishers,
                            const wire::ReaderStatistics& statistics, const Pulse& pulse) const;
  SourceReport camera_report() const;
  std::string camera_trouble() const;
  double longest_silence() const;

  const OnFrame on_frame_;
  const LogHook log_;
  mutable std::mutex mutex_;  ///< Guards the options and the synchronizer.
  InputOptions options_;
  Synchronizer synchronizer_;
  Pulse frames_pulse_, cloud_pulse_, info_pulse_;
  // Last: they call into the members above until they are destroyed.
  std::optional<wire::Subscriber<wire::bpa_msgs::RgbdFrame>> frames_;
  std::optional<wire::Subscriber<wire::sensor_msgs::PointCloud2>> cloud_;
  ImageTopic color_, depth_;
  std::optional<wire::Subscriber<wire::sensor_msgs::CameraInfo>> info_;
};

}  // namespace bpa::server
