// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/sources/topic_source.hpp"

#include <utility>

#include "server/convert/frames.hpp"
#include "server/convert/priors.hpp"

namespace bpa::server {
namespace {

using wire::SampleMeta;
using wire::Subscriber;
using wire::bpa_msgs::RgbdFrame;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::CompressedImage;
using wire::sensor_msgs::Image;
using wire::sensor_msgs::PointCloud2;

SynchronizerOptions synchronizer_options(const InputOptions& options) {
  SynchronizerOptions sync;
  sync.with_color = !options.color.empty();
  sync.tolerance_ns = static_cast<std::int64_t>(options.sync_tolerance_ms * 1e6);
  sync.queue = static_cast<std::size_t>(options.sync_queue);
  return sync;
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

template <class T, class OnMessage>
Status TopicSource::subscribe_to(const wire::Participant& participant, const std::string& topic,
                                 const wire::SubscriberOptions& options, OnMessage on_message,
                                 Topic& place) {
  auto made = Subscriber<T>::create(participant, topic, options,
                                    [&place, on_message](T&& message, const SampleMeta&) {
                                      place.pulse.beat();
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

TopicSource::TopicSource(const InputOptions& options, OnFrame on_frame, LogHook log)
    : on_frame_(std::move(on_frame)),
      log_(std::move(log)),
      options_(options),
      synchronizer_(synchronizer_options(options)) {}

Result<std::unique_ptr<TopicSource>> TopicSource::create(const wire::Participant& participant,
                                                         const ServerOptions& options,
                                                         OnFrame on_frame, LogHook log) {
  std::unique_ptr<TopicSource> source(
      new TopicSource(options.input, std::move(on_frame), std::move(log)));
  if (Status status = source->subscribe(participant, options); !status.ok()) return status;
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

Status TopicSource::subscribe(const wire::Participant& participant, const ServerOptions& options) {
  if (!options_.frames.empty()) {
    const auto shared_bytes = static_cast<std::size_t>(options.network.shared_frame_mb) << 20U;
    if (Status s = subscribe_frames(participant, shared_bytes); !s.ok()) return s;
  }
  if (!options_.cloud.empty()) {
    if (Status s = subscribe_cloud(participant); !s.ok()) return s;
  }
  return options_.depth.empty() ? Status() : subscribe_camera(participant);
}

Status TopicSource::subscribe_frames(const wire::Participant& participant,
                                     std::size_t shared_bytes) {
  wire::SubscriberOptions subscription;
  subscription.qos = wire::qos::frames();
  if (!options_.frames_reliable) subscription.qos.reliability = wire::Reliability::best_effort;
  subscription.shared_bytes = shared_bytes;
  Status status = subscribe_to<RgbdFrame>(
      participant, options_.frames, subscription,
      [this](RgbdFrame&& message) { on_frame_(incoming(std::move(message))); }, frames_);
  if (status.ok()) log(log_, LogLevel::info, "frames are taken from " + frames_.name);
  return status;
}

Status TopicSource::subscribe_cloud(const wire::Participant& participant) {
  Status status = subscribe_to<PointCloud2>(
      participant, options_.cloud, camera_subscription(),
      [this](PointCloud2&& message) { on_frame_(incoming(std::move(message), frame_from_cloud)); },
      cloud_);
  if (status.ok()) log(log_, LogLevel::info, "clouds are taken from " + cloud_.name);
  return status;
}

wire::SubscriberOptions TopicSource::camera_subscription() const {
  wire::SubscriberOptions subscription;
  subscription.qos = options_.reliable ? wire::qos::reliable_input() : wire::qos::sensor_input();
  return subscription;
}

Status TopicSource::subscribe_images(const wire::Participant& participant, const std::string& topic,
                                     const std::string& transport,
                                     void (Synchronizer::*add)(AnyImage&&), Topic& place) {
  const auto take = [this, add](auto&& image) {
    std::unique_lock<std::mutex> lock(mutex_);
    (synchronizer_.*add)(AnyImage(std::move(image)));
    deliver_complete(std::move(lock));
  };
  if (transport == "raw") {
    return subscribe_to<Image>(participant, topic, camera_subscription(), take, place);
  }
  // As image_transport does it, the base topic is remapped first.
  const Result<std::string> base = participant.resolve(topic);
  if (!base.ok()) return base.status();
  return subscribe_to<CompressedImage>(participant, *base + "/" + transport, camera_subscription(),
                                       take, place);
}

Status TopicSource::subscribe_camera(const wire::Participant& participant) {
  if (!options_.color.empty()) {
    Status status = subscribe_images(participant, options_.color, options_.color_transport,
                                     &Synchronizer::add_color, color_);
    if (!status.ok()) return status;
  }
  Status status = subscribe_images(participant, options_.depth, options_.depth_transport,
                                   &Synchronizer::add_depth, depth_);
  if (!status.ok()) return status;
  status = subscribe_to<CameraInfo>(
      participant, options_.camera_info, camera_subscription(),
      [this](CameraInfo&& info) {
        std::unique_lock<std::mutex> lock(mutex_);
        synchronizer_.add_info(std::move(info));
        deliver_complete(std::move(lock));
      },
      info_);
  if (!status.ok()) return status;
  log(log_, LogLevel::info,
      "camera images are taken from " + depth_.name +
          (color_.open() ? ", " + color_.name : " (without colour)") + " and " + info_.name);
  return {};
}

void TopicSource::deliver_complete(std::unique_lock<std::mutex> lock) {
  std::vector<CameraImages> complete;
  while (auto images = synchronizer_.next()) complete.push_back(*std::move(images));
  const bool rectified = options_.rectified;
  lock.unlock();
  for (CameraImages& images : complete) on_frame_(incoming(std::move(images), rectified));
}

SyncCounts TopicSource::sync_counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return synchronizer_.counts();
}

}  // namespace bpa::server
