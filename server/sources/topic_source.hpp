// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
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
  /// Subscribes to what the options name. `on_frame` runs on DDS threads; `participant` outlives
  /// it.
  static Result<std::unique_ptr<TopicSource>> create(const wire::Participant& participant,
                                                     const ServerOptions& options, OnFrame on_frame,
                                                     LogHook log);

  /// Takes over what may change at run time: rectified, sync_tolerance_ms, sync_queue, silence_s.
  void set_options(const InputOptions& options);

  std::vector<SourceReport> reports() const override;
  /// Publishers of the topic of whole frames that are matched now; 0 without that topic.
  std::size_t frame_publishers() const { return frames_.open() ? frames_.publishers() : 0; }
  /// What became of the camera's messages.
  SyncCounts sync_counts() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return synchronizer_.counts();
  }

 private:
  /// A subscription to messages of any type.
  struct Topic {
    std::string name;  ///< Resolved.
    std::function<std::size_t()> publishers;
    std::function<wire::ReaderStatistics()> statistics;
    std::shared_ptr<void> subscriber;
    std::atomic<std::int64_t> last_ns{0};  ///< When the last message came (steady_clock); 0: none.

    bool open() const { return subscriber != nullptr; }
    /// Seconds since the last message; nothing before the first.
    std::optional<double> silence() const;
  };

  TopicSource(const wire::Participant& participant, const InputOptions& options, OnFrame on_frame,
              LogHook log);
  // Each does nothing when its topic is empty.
  Status subscribe_frames(std::size_t shared_bytes);
  Status subscribe_cloud();
  Status subscribe_camera();
  Status subscribe_images(const std::string& topic, const std::string& transport,
                          void (Synchronizer::*add)(AnyImage&&), Topic& place);
  template <class T, class OnMessage>
  Status subscribe(const std::string& topic, const wire::SubscriberOptions& options,
                   OnMessage on_message, Topic& place);
  wire::SubscriberOptions camera_subscription() const;
  /// Adds a message of the camera and hands on the images that it completes.
  template <class Message>
  void synchronize(void (Synchronizer::*add)(Message&&), Message message);
  SourceReport whole_report(const std::string& what, const Topic& topic) const;
  SourceReport camera_report() const;
  std::string camera_trouble() const;
  double longest_silence() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return options_.silence_s;
  }

  const wire::Participant& participant_;
  const OnFrame on_frame_;
  const LogHook log_;
  mutable std::mutex mutex_;  ///< Guards the options and the synchronizer.
  InputOptions options_;
  Synchronizer synchronizer_;
  // Last: they call into the members above until they are destroyed.
  Topic frames_, cloud_, color_, depth_, info_;
};

}  // namespace bpa::server
