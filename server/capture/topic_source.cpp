// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <bpa/server/capture/topic_source.hpp>
#include <bpa/server/convert/frames.hpp>

namespace bpa::server {
namespace {

using wire::SampleMeta;
using wire::Subscriber;
using wire::bpa_msgs::RgbdFrame;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::Image;

SynchronizerOptions synchronizer_options(const InputOptions& options) {
  SynchronizerOptions sync;
  sync.with_color = !options.color.empty();
  sync.tolerance_ns = static_cast<std::int64_t>(options.sync_tolerance_ms * 1e6);
  sync.queue = static_cast<std::size_t>(options.sync_queue);
  return sync;
}

/// Creates a subscription in `place`.
template <class T>
Status subscribe_to(const wire::Participant& participant, const std::string& topic,
                    const wire::SubscriberOptions& options,
                    typename Subscriber<T>::Callback callback,
                    std::optional<Subscriber<T>>& place) {
  auto subscriber = Subscriber<T>::create(participant, topic, options, std::move(callback));
  if (!subscriber.ok()) return subscriber.status();
  place.emplace(std::move(subscriber).value());
  return {};
}

IncomingFrame incoming(RgbdFrame&& message) {
  const auto shared = std::make_shared<const RgbdFrame>(std::move(message));
  return {[shared] { return frame_from_message(*shared); }, to_ns(shared->header.stamp),
          shared->header.frame_id};
}

IncomingFrame incoming(CameraImages images, bool rectified) {
  const wire::std_msgs::Header& header = images.depth->header;
  IncomingFrame frame{{}, to_ns(header.stamp), header.frame_id};
  frame.decode = [images = std::move(images), rectified] {
    return frame_from_images(images, rectified);
  };
  return frame;
}

}  // namespace

TopicSource::TopicSource(const InputOptions& options, OnFrame on_frame, LogHook log)
    : options_(options),
      on_frame_(std::move(on_frame)),
      log_(std::move(log)),
      synchronizer_(synchronizer_options(options)) {}

Result<std::unique_ptr<TopicSource>> TopicSource::create(const wire::Participant& participant,
                                                         const ServerOptions& options,
                                                         OnFrame on_frame, LogHook log) {
  std::unique_ptr<TopicSource> source(
      new TopicSource(options.input, std::move(on_frame), std::move(log)));
  if (Status status = source->subscribe(participant, options); !status.ok()) return status;
  return source;
}

Status TopicSource::subscribe(const wire::Participant& participant, const ServerOptions& options) {
  if (!options_.frames.empty()) {
    wire::SubscriberOptions subscription;
    subscription.qos = wire::qos::frames();
    if (!options_.frames_reliable) subscription.qos.reliability = wire::Reliability::best_effort;
    subscription.shared_bytes = static_cast<std::size_t>(options.network.shared_frame_mb) << 20U;
    Status status = subscribe_to<RgbdFrame>(
        participant, options_.frames, subscription,
        [this](RgbdFrame&& message, const SampleMeta&) { on_frame_(incoming(std::move(message))); },
        frames_);
    if (!status.ok()) return status;
    log(log_, LogLevel::info, "frames are taken from " + frames_->topic());
  }
  return options_.depth.empty() ? Status() : subscribe_camera(participant);
}

Status TopicSource::subscribe_camera(const wire::Participant& participant) {
  wire::SubscriberOptions subscription;
  subscription.qos = options_.reliable ? wire::qos::reliable_input() : wire::qos::sensor_input();
  if (!options_.color.empty()) {
    Status status = subscribe_to<Image>(
        participant, options_.color, subscription,
        [this](Image&& image, const SampleMeta&) {
          std::unique_lock<std::mutex> lock(mutex_);
          synchronizer_.add_color(std::move(image));
          deliver_complete(std::move(lock));
        },
        color_);
    if (!status.ok()) return status;
  }
  Status status = subscribe_to<Image>(
      participant, options_.depth, subscription,
      [this](Image&& image, const SampleMeta&) {
        std::unique_lock<std::mutex> lock(mutex_);
        synchronizer_.add_depth(std::move(image));
        deliver_complete(std::move(lock));
      },
      depth_);
  if (!status.ok()) return status;
  status = subscribe_to<CameraInfo>(
      participant, options_.camera_info, subscription,
      [this](CameraInfo&& info, const SampleMeta&) {
        std::unique_lock<std::mutex> lock(mutex_);
        synchronizer_.add_info(std::move(info));
        deliver_complete(std::move(lock));
      },
      info_);
  if (!status.ok()) return status;
  log(log_, LogLevel::info,
      "camera images are taken from " + depth_->topic() +
          (color_ ? ", " + color_->topic() : " (without colour)") + " and " + info_->topic());
  return {};
}

void TopicSource::deliver_complete(std::unique_lock<std::mutex> lock) {
  std::vector<CameraImages> complete;
  while (auto images = synchronizer_.next()) complete.push_back(*std::move(images));
  lock.unlock();
  for (CameraImages& images : complete) {
    on_frame_(incoming(std::move(images), options_.rectified));
  }
}

SyncCounts TopicSource::sync_counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return synchronizer_.counts();
}

wire::ReaderStatistics TopicSource::reader_statistics() const {
  wire::ReaderStatistics sum;
  const auto add = [&sum](const auto& subscriber) {
    if (!subscriber) return;
    const wire::ReaderStatistics one = subscriber->statistics();
    sum.received += one.received;
    sum.malformed += one.malformed;
    sum.lost += one.lost;
  };
  add(frames_);
  add(color_);
  add(depth_);
  add(info_);
  return sum;
}

}  // namespace bpa::server
