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
/// left to the worker.
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
  std::size_t frame_publishers() const { return frames_.open() ? frames_.publishers() : 0; }
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

  /// A subscription to messages of any type, and when the last one came.
  struct Topic {
    std::string name;  ///< Resolved.
    Pulse pulse;
    std::function<std::size_t()> publishers;
    std::function<wire::ReaderStatistics()> statistics;
    std::shared_ptr<void> subscriber;

    bool open() const { return subscriber != nullptr; }
  };

  TopicSource(const InputOptions& options, OnFrame on_frame, LogHook log);
  Status subscribe(const wire::Participant& participant, const ServerOptions& options);
  Status subscribe_frames(const wire::Participant& participant, std::size_t shared_bytes);
  Status subscribe_cloud(const wire::Participant& participant);
  Status subscribe_camera(const wire::Participant& participant);
  Status subscribe_images(const wire::Participant& participant, const std::string& topic,
                          const std::string& transport, void (Synchronizer::*add)(AnyImage&&),
                          Topic& place);
  template <class T, class OnMessage>
  static Status subscribe_to(const wire::Participant& participant, const std::string& topic,
                             const wire::SubscriberOptions& options, OnMessage on_message,
                             Topic& place);
  wire::SubscriberOptions camera_subscription() const;
  void deliver_complete(std::unique_lock<std::mutex> lock);
  SourceReport whole_report(const std::string& what, const Topic& topic) const;
  SourceReport camera_report() const;
  std::string camera_trouble() const;
  double longest_silence() const;

  const OnFrame on_frame_;
  const LogHook log_;
  mutable std::mutex mutex_;  ///< Guards the options and the synchronizer.
  InputOptions options_;
  Synchronizer synchronizer_;
  // Last: they call into the members above until they are destroyed.
  Topic frames_, cloud_, color_, depth_, info_;
};

}  // namespace bpa::server
