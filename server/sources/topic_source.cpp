// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/topic_source.hpp"

#include <chrono>
#include <utility>

#include "server/convert/frames.hpp"

namespace bpa::server {
namespace {

using wire::Subscriber;
using wire::bpa_msgs::RgbdFrame;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::CompressedImage;
using wire::sensor_msgs::Image;
using wire::sensor_msgs::PointCloud2;

SynchronizerOptions synchronizer_options(const InputOptions& options) {
  return {!options.color.empty(), static_cast<std::int64_t>(options.sync_tolerance_ms * 1e6),
          static_cast<std::size_t>(options.sync_queue)};
}

/// A whole frame; `convert` runs on the worker.
template <class Message, class Convert>
IncomingFrame incoming(Message message, Convert convert) {
  IncomingFrame frame{{}, to_ns(message.header.stamp), message.header.frame_id};
  frame.decode = [message = std::move(message), convert]() mutable {
    return convert(std::move(message));
  };
  return frame;
}

IncomingFrame incoming(RgbdFrame message) {
  auto priors = priors_from_messages(message.priors);
  IncomingFrame frame = incoming(std::move(message), frame_from_message);
  if (priors.ok()) {
    frame.priors = std::move(priors).value();
  } else {
    frame.decode = [status = priors.status()] {
      return DecodedFrame(RejectionCause::priors, status);
    };
  }
  return frame;
}

IncomingFrame incoming(CameraImages images, bool rectified) {
  const wire::std_msgs::Header& header = header_of(*images.depth);
  IncomingFrame frame{{}, to_ns(header.stamp), header.frame_id};
  frame.decode = [images = std::move(images), rectified] {
    return frame_from_images(images, rectified);
  };
  return frame;
}

}  // namespace

TopicSource::TopicSource(const wire::Participant& participant, const InputOptions& options,
                         OnFrame on_frame, LogHook log)
    : participant_(participant),
      on_frame_(std::move(on_frame)),
      log_(std::move(log)),
      options_(options),
      synchronizer_(synchronizer_options(options)) {}

Result<std::unique_ptr<TopicSource>> TopicSource::create(const wire::Participant& participant,
                                                         const ServerOptions& options,
                                                         OnFrame on_frame, LogHook log) {
  std::unique_ptr<TopicSource> source(
      new TopicSource(participant, options.input, std::move(on_frame), std::move(log)));
  const auto shared_bytes = static_cast<std::size_t>(options.network.shared_frame_mb) << 20U;
  if (Status status = source->subscribe_frames(shared_bytes); !status.ok()) return status;
  if (Status status = source->subscribe_cloud(); !status.ok()) return status;
  if (Status status = source->subscribe_camera(); !status.ok()) return status;
  return source;
}

void TopicSource::set_options(const InputOptions& options) {
  const std::lock_guard<std::mutex> lock(mutex_);
  options_.rectified = options.rectified;
  options_.sync_tolerance_ms = options.sync_tolerance_ms;
  options_.sync_queue = options.sync_queue;
  options_.silence_s = options.silence_s;
  synchronizer_.set_options(synchronizer_options(options_));
}

template <class T, class OnMessage>
Status TopicSource::subscribe(const std::string& topic, const wire::SubscriberOptions& options,
                              OnMessage on_message, Topic& place) {
  auto made = Subscriber<T>::create(
      participant_, topic, options, [&place, on_message](T&& message, const wire::SampleMeta&) {
        place.last_ns = std::chrono::steady_clock::now().time_since_epoch().count();
        on_message(std::move(message));
      });
  if (!made.ok()) return made.status();
  const auto subscriber = std::make_shared<Subscriber<T>>(std::move(made).value());
  place.name = subscriber->topic();
  place.publishers = [raw = subscriber.get()] { return raw->matched_count(); };
  place.statistics = [raw = subscriber.get()] { return raw->statistics(); };
  place.subscriber = subscriber;
  return {};
}

Status TopicSource::subscribe_frames(std::size_t shared_bytes) {
  if (options_.frames.empty()) return {};
  wire::SubscriberOptions subscription{wire::qos::frames(), shared_bytes};
  if (!options_.frames_reliable) subscription.qos.reliability = wire::Reliability::best_effort;
  Status status = subscribe<RgbdFrame>(
      options_.frames, subscription,
      [this](RgbdFrame&& message) { on_frame_(incoming(std::move(message))); }, frames_);
  if (status.ok()) log(log_, LogLevel::info, "frames are taken from " + frames_.name);
  return status;
}

wire::SubscriberOptions TopicSource::camera_subscription() const {
  return {options_.reliable ? wire::qos::reliable_input() : wire::qos::sensor_input()};
}

Status TopicSource::subscribe_cloud() {
  if (options_.cloud.empty()) return {};
  Status status = subscribe<PointCloud2>(
      options_.cloud, camera_subscription(),
      [this](PointCloud2&& message) { on_frame_(incoming(std::move(message), frame_from_cloud)); },
      cloud_);
  if (status.ok()) log(log_, LogLevel::info, "clouds are taken from " + cloud_.name);
  return status;
}

template <class Message>
void TopicSource::synchronize(void (Synchronizer::*add)(Message&&), Message message) {
  std::unique_lock<std::mutex> lock(mutex_);
  (synchronizer_.*add)(std::move(message));
  std::vector<CameraImages> complete;
  while (auto images = synchronizer_.next()) complete.push_back(*std::move(images));
  const bool rectified = options_.rectified;
  lock.unlock();
  for (CameraImages& images : complete) on_frame_(incoming(std::move(images), rectified));
}

Status TopicSource::subscribe_images(const std::string& topic, const std::string& transport,
                                     void (Synchronizer::*add)(AnyImage&&), Topic& place) {
  if (topic.empty()) return {};
  const auto take = [this, add](auto&& image) { synchronize(add, AnyImage(std::move(image))); };
  if (transport == "raw") return subscribe<Image>(topic, camera_subscription(), take, place);
  // As image_transport does it, the base topic is remapped first.
  const Result<std::string> base = participant_.resolve(topic);
  if (!base.ok()) return base.status();
  return subscribe<CompressedImage>(*base + "/" + transport, camera_subscription(), take, place);
}

Status TopicSource::subscribe_camera() {
  if (options_.depth.empty()) return {};
  Status status =
      subscribe_images(options_.color, options_.color_transport, &Synchronizer::add_color, color_);
  if (!status.ok()) return status;
  status =
      subscribe_images(options_.depth, options_.depth_transport, &Synchronizer::add_depth, depth_);
  if (!status.ok()) return status;
  status = subscribe<CameraInfo>(
      options_.camera_info, camera_subscription(),
      [this](CameraInfo&& info) { synchronize(&Synchronizer::add_info, std::move(info)); }, info_);
  if (!status.ok()) return status;
  log(log_, LogLevel::info,
      "camera images are taken from " + depth_.name +
          (color_.open() ? ", " + color_.name : " (without colour)") + " and " + info_.name);
  return {};
}

SyncCounts TopicSource::sync_counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return synchronizer_.counts();
}

}  // namespace bpa::server
