// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "idl/wire/participant.hpp"
#include "server/convert/frames.hpp"
#include "server/options.hpp"
#include "server/output.hpp"

namespace bpa::server {

/// A frame as an organised cloud: x y z in metres and rgb, 16 bytes a point; NaN where there is no
/// depth. Colour is black in a frame without.
wire::sensor_msgs::PointCloud2 cloud_message(const Frame& frame);

/// Publishes the images of the server's own camera as a ROS 2 camera driver does. It sends on a
/// thread of its own: a slow subscriber costs images, not the capture's time.
class CameraPublisher {
 public:
  static Result<std::unique_ptr<CameraPublisher>> create(const wire::Participant& participant,
                                                         const CaptureOptions& options,
                                                         LogHook log);
  ~CameraPublisher();

  /// Takes the images to publish; those that wait give way to them.
  void publish(const CameraImages& images);
  /// Sets of images that gave way to newer ones.
  std::uint64_t dropped() const;

 private:
  explicit CameraPublisher(LogHook log) : log_(std::move(log)) {}
  void run();
  void send(const CameraImages& images);

  const LogHook log_;
  Output<wire::sensor_msgs::Image> color_, depth_;
  Output<wire::sensor_msgs::CameraInfo> color_info_, depth_info_;
  Output<wire::sensor_msgs::PointCloud2> points_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<CameraImages> next_;
  std::uint64_t dropped_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace bpa::server
