// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include <bpa/core/base/log.hpp>
#include <bpa/core/base/status.hpp>
#include <bpa/server/capture/synchronizer.hpp>
#include <bpa/server/options.hpp>
#include <bpa/server/worker.hpp>
#include <bpa/wire/messages.hpp>
#include <bpa/wire/participant.hpp>
#include <bpa/wire/subscriber.hpp>

namespace bpa::server {

/// Takes frames from topics: whole ones (bpa_msgs/RgbdFrame) and the images of a ROS 2 camera, put
/// together by their stamps. DDS threads only sort messages; decoding them is left to whoever takes
/// the IncomingFrame.
class TopicSource {
 public:
  using OnFrame = std::function<void(IncomingFrame&&)>;

  /// Subscribes to what the options name. `on_frame` runs on DDS threads.
  static Result<std::unique_ptr<TopicSource>> create(const wire::Participant& participant,
                                                     const ServerOptions& options, OnFrame on_frame,
                                                     LogHook log);

  /// What became of the camera's messages.
  SyncCounts sync_counts() const;
  /// Messages that were no legal encoding of their type, and those lost by DDS.
  wire::ReaderStatistics reader_statistics() const;
  /// Publishers of whole frames, and of depth images, at present.
  std::size_t frame_publishers() const { return frames_ ? frames_->matched_count() : 0; }
  std::size_t camera_publishers() const { return depth_ ? depth_->matched_count() : 0; }

 private:
  TopicSource(const InputOptions& options, OnFrame on_frame, LogHook log);
  Status subscribe(const wire::Participant& participant, const ServerOptions& options);
  Status subscribe_camera(const wire::Participant& participant);
  void deliver_complete(std::unique_lock<std::mutex> lock);

  const InputOptions options_;
  const OnFrame on_frame_;
  const LogHook log_;
  mutable std::mutex mutex_;  ///< Guards the synchronizer.
  Synchronizer synchronizer_;
  // Last: they call into the members above until they are destroyed.
  std::optional<wire::Subscriber<wire::bpa_msgs::RgbdFrame>> frames_;
  std::optional<wire::Subscriber<wire::sensor_msgs::Image>> color_;
  std::optional<wire::Subscriber<wire::sensor_msgs::Image>> depth_;
  std::optional<wire::Subscriber<wire::sensor_msgs::CameraInfo>> info_;
};

}  // namespace bpa::server
