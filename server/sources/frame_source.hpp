// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "camera/camera_device.hpp"
#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "core/cloud/frame.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "ros/frames.hpp"
#include "ros/synchronizer.hpp"
#include "server/busy.hpp"
#include "server/convert/results.hpp"
#include "server/services/requests.hpp"
#include "server/statistics.hpp"

namespace bpa::server {

struct CaptureOptions;
struct IncomingFrame;
struct InputOptions;
struct ServerOptions;
class TfBuffer;

/// Takes a frame, on a thread of its source.
using OnFrame = std::function<void(IncomingFrame&&)>;

/// How one source of frames is doing. `name` is unique in the server ("camera"), `message` one
/// sentence for people, `hardware_id` the device or the topic.
using SourceReport = wire::diagnostic_msgs::DiagnosticStatus;

/// A source of frames. It starts when it is made. Until it is destroyed, threads of its own hand
/// frames to its owner.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// From any thread, at any time.
  virtual std::vector<SourceReport> reports() const = 0;
  /// Of the services of this source.
  virtual RequestLosses losses() const { return {}; }
  /// Begins or ends a recording; `unsupported` where the source has no camera of its own.
  virtual void record(const wire::bpa_msgs::Record_Request& request,
                      const Answer<wire::bpa_msgs::Record>& answer);
  /// What threads of its own do now that must not hang.
  virtual std::vector<const Busy*> threads() const { return {}; }
};

/// Frames from topics: whole ones (bpa_msgs/RgbdFrame), organised clouds, and the images of a ROS 2
/// camera, put together by their stamps.
class TopicSource : public FrameSource {
 public:
  /// Takes over what may change at run time: rectified, sync_tolerance_ms, sync_queue, silence_s.
  virtual void set_options(const InputOptions& options) = 0;
  /// Publishers of the topic of whole frames that are matched now; 0 without that topic.
  virtual std::size_t frame_publishers() const = 0;
  /// What became of the camera's messages.
  virtual ros::SyncCounts sync_counts() const = 0;
};

/// Subscribes to what the options name. `on_frame` runs on DDS threads; `participant` outlives the
/// source. `clock` measures how long no message came. Throws a Failure.
std::unique_ptr<TopicSource> open_topic_source(const wire::Participant& participant,
                                               const ServerOptions& options, OnFrame on_frame,
                                               std::shared_ptr<const WaitableClock> clock,
                                               LogHook log);

/// The server's own camera. Its frames go to the search and to camera topics. A service records it,
/// and diagnostics report it. The capture thread calls `on_frame` and `idle` (whether no frame
/// waits for the search); transforms of a recording go to `transforms`. Throws a Failure.
std::unique_ptr<FrameSource> open_camera_source(const wire::Participant& participant,
                                                const CaptureOptions& options, OnFrame on_frame,
                                                std::function<bool()> idle, TfBuffer& transforms,
                                                LogHook log);

/// The images of the server's own camera as messages in the frame `frame_id`: 16UC1 or 32FC1 depth,
/// rgb8 or mono8 colour. Up to 5 coefficients of distortion: plumb_bob; more: rational_polynomial.
ros::CameraImages image_messages(camera::SensorImages images, const std::string& frame_id);

/// A frame as an organised cloud: x y z in metres and rgb, 16 bytes a point; NaN where there is no
/// depth. Colour is black in a frame without.
wire::sensor_msgs::PointCloud2 cloud_message(const Frame& frame);

}  // namespace bpa::server
