// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/clock.hpp"
#include "core/base/failure.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/options.hpp"
#include "server/search_queue.hpp"
#include "server/sources/frame_source.hpp"

namespace bpa::server {
namespace {

using wire::Subscriber;
using wire::bpa_msgs::RgbdFrame;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::CompressedImage;
using wire::sensor_msgs::Image;
using wire::sensor_msgs::PointCloud2;

ros::SynchronizerOptions synchronizer_options(const InputOptions& options) {
  return {!options.color.empty(), static_cast<std::int64_t>(options.sync_tolerance_ms * 1e6),
          static_cast<std::size_t>(options.sync_queue)};
}

/// A whole frame; `convert` runs on a search thread.
IncomingFrame incoming(auto message, auto convert) {
  IncomingFrame frame{{}, to_ns(message.header.stamp), message.header.frame_id};
  frame.decode = [message = std::move(message), convert]() mutable {
    return convert(std::move(message));
  };
  return frame;
}

IncomingFrame incoming(RgbdFrame message) {
  auto priors = ros::priors_from_messages(message.priors);
  IncomingFrame frame = incoming(std::move(message), ros::frame_from_message);
  if (priors.ok()) {
    frame.priors = std::move(priors).value();
  } else {
    frame.decode = [status = priors.status()] {
      return ros::DecodedFrame(ros::RejectionCause::priors, status);
    };
  }
  return frame;
}

IncomingFrame incoming(ros::CameraImages images, bool rectified) {
  const wire::std_msgs::Header& header = ros::header_of(*images.depth);
  return {[images, rectified] { return ros::frame_from_images(images, rectified); },
          to_ns(header.stamp), header.frame_id};
}

using Values = std::vector<wire::diagnostic_msgs::KeyValue>;

void add(Values& values, const std::string& key, std::uint64_t value) {
  values.push_back({key, std::to_string(value)});
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", value);
  return text;
}

/// A subscription to messages of any type.
struct Topic {
  std::string name;  ///< Resolved.
  std::function<std::size_t()> publishers;
  std::function<wire::ReaderStatistics()> statistics;
  std::shared_ptr<void> subscriber;
  std::atomic<WaitableClock::TimePoint> last{};  ///< When the last message came; zero: none.

  bool open() const { return subscriber != nullptr; }
  /// Seconds since the last message; nothing before the first. Reports tell by it that a camera is
  /// gone: publishers on Eclipse Cyclone DDS count as matched for seconds after they went.
  std::optional<double> silence(const WaitableClock& clock) const {
    if (last.load() == WaitableClock::TimePoint()) return std::nullopt;
    return std::chrono::duration<double>(clock.now() - last.load()).count();
  }
};

/// DDS threads only sort messages; search threads decode them.
class Topics : public TopicSource {
 public:
  Topics(const wire::Participant& participant, const ServerOptions& options, OnFrame on_frame,
         std::shared_ptr<const WaitableClock> clock, LogHook hook)
      : participant_(participant),
        on_frame_(std::move(on_frame)),
        clock_(std::move(clock)),
        log_(std::move(hook)),
        options_(options.input),
        synchronizer_(synchronizer_options(options.input)) {
    wire::SubscriberOptions whole{wire::qos::frames()};
    if (!options_.frames_reliable) whole.qos.reliability = wire::Reliability::best_effort;
    if (!options_.frames.empty()) {
      subscribe<RgbdFrame>(
          options_.frames, whole,
          [this](RgbdFrame&& message) { on_frame_(incoming(std::move(message))); }, frames_);
      log(log_, LogLevel::info, "frames are taken from " + frames_.name);
    }
    const wire::SubscriberOptions camera{options_.reliable ? wire::qos::reliable_input()
                                                           : wire::qos::sensor_input()};
    if (!options_.cloud.empty()) {
      const auto take = [this, unit = options_.cloud_unit_m](PointCloud2&& message) {
        on_frame_(incoming(std::move(message), [unit](const PointCloud2& cloud) {
          return ros::frame_from_cloud(cloud, unit);
        }));
      };
      subscribe<PointCloud2>(options_.cloud, camera, take, cloud_);
      log(log_, LogLevel::info, "clouds are taken from " + cloud_.name);
    }
    if (!options_.depth.empty()) subscribe_camera(camera);
  }

  void set_options(const InputOptions& options) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    options_.rectified = options.rectified;
    options_.sync_tolerance_ms = options.sync_tolerance_ms;
    options_.sync_queue = options.sync_queue;
    options_.silence_s = options.silence_s;
    synchronizer_.set_options(synchronizer_options(options_));
  }

  std::vector<SourceReport> reports() const override {
    std::vector<SourceReport> reports;
    if (frames_.open()) reports.push_back(whole_report("frames", frames_));
    if (cloud_.open()) reports.push_back(whole_report("clouds", cloud_));
    if (depth_.open()) reports.push_back(camera_report());
    return reports;
  }

  std::size_t frame_publishers() const override {
    return frames_.open() ? frames_.publishers() : 0;
  }

  ros::SyncCounts sync_counts() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return synchronizer_.counts();
  }

 private:
  template <class T, class OnMessage>
  void subscribe(const std::string& topic, const wire::SubscriberOptions& options,
                 OnMessage on_message, Topic& place) {
    const auto subscriber = std::make_shared<Subscriber<T>>(or_throw(
        Subscriber<T>::create(participant_, topic, options,
                              [this, &place, on_message](T&& message, const wire::SampleMeta&) {
                                place.last = clock_->now();
                                on_message(std::move(message));
                              })));
    place.name = subscriber->topic();
    place.publishers = [raw = subscriber.get()] { return raw->matched_count(); };
    place.statistics = [raw = subscriber.get()] { return raw->statistics(); };
    place.subscriber = subscriber;
  }

  /// Adds a message of the camera and hands on the images that it completes.
  template <class Message>
  void synchronize(void (ros::Synchronizer::*add)(Message&&), Message message) {
    std::unique_lock<std::mutex> lock(mutex_);
    (synchronizer_.*add)(std::move(message));
    std::vector<ros::CameraImages> complete;
    while (auto images = synchronizer_.next()) complete.push_back(*std::move(images));
    const bool rectified = options_.rectified || ros::named_rectified(info_owner());
    lock.unlock();
    for (ros::CameraImages& images : complete) on_frame_(incoming(std::move(images), rectified));
  }

  /// The topic whose images the camera info is of.
  const std::string& info_owner() const {
    return options_.color.empty() ? options_.depth : options_.color;
  }

  /// Does nothing when the topic is empty.
  void subscribe_images(const std::string& topic, const std::string& transport,
                        const wire::SubscriberOptions& options,
                        void (ros::Synchronizer::*add)(ros::AnyImage&&), Topic& place) {
    if (topic.empty()) return;
    const auto take = [this, add](auto&& image) {
      synchronize(add, ros::AnyImage(std::move(image)));
    };
    if (transport == "raw") return subscribe<Image>(topic, options, take, place);
    // As image_transport does it, the base topic is remapped first.
    const std::string base = or_throw(participant_.resolve(topic));
    subscribe<CompressedImage>(base + "/" + transport, options, take, place);
  }

  void subscribe_camera(const wire::SubscriberOptions& options) {
    subscribe_images(options_.color, options_.color_transport, options,
                     &ros::Synchronizer::add_color, color_);
    subscribe_images(options_.depth, options_.depth_transport, options,
                     &ros::Synchronizer::add_depth, depth_);
    subscribe<CameraInfo>(
        options_.camera_info, options,
        [this](CameraInfo&& info) { synchronize(&ros::Synchronizer::add_info, std::move(info)); },
        info_);
    log(log_, LogLevel::info,
        "camera images are taken from " + depth_.name +
            (color_.open() ? ", " + color_.name : " (without colour)") + " and " + info_.name +
            (ros::named_rectified(info_owner()) ? "; rectified, by their name" : ""));
  }

  SourceReport whole_report(const std::string& what, const Topic& topic) const {
    SourceReport report;
    report.name = what;
    report.hardware_id = topic.name;
    const std::size_t publishers = topic.publishers();
    const auto silence = topic.silence(*clock_);
    if (!silence) {
      report.message = publishers > 0 ? "a publisher is there and has sent nothing yet" : "unused";
    } else if (*silence > longest_silence()) {
      report.level = SourceReport::kWarn;
      report.message = "nothing has come for " + seconds(*silence);
    } else {
      report.message = "they come";
    }
    const wire::ReaderStatistics statistics = topic.statistics();
    add(report.values, "publishers of " + what, publishers);
    add(report.values, "messages of " + what, statistics.received);
    add(report.values, "messages malformed of " + what, statistics.malformed);
    add(report.values, "messages lost by DDS of " + what, statistics.lost);
    add(report.values, "publishers with too weak QoS of " + what, statistics.incompatible);
    return report;
  }

  /// What is wrong with the camera's topics, or an empty text.
  std::string camera_trouble() const {
    const double limit = longest_silence();
    std::string trouble;
    bool alive = false, seen = false;
    const auto judge = [&](const char* what, const Topic& topic) {
      if (!topic.open()) return;
      const auto silence = topic.silence(*clock_);
      seen = seen || silence;
      if (silence && *silence <= limit) {
        alive = true;
        return;
      }
      trouble += (trouble.empty() ? "no " : "; no ") + std::string(what) + " on " + topic.name +
                 (silence ? " for " + seconds(*silence) : " so far") +
                 (topic.publishers() == 0 ? ", nobody publishes it" : "");
    };
    judge("colour image", color_);
    judge("depth image", depth_);
    judge("camera info", info_);
    if (!seen) return "";
    return alive || trouble.empty() ? trouble : "the camera is gone: " + trouble;
  }

  SourceReport camera_report() const {
    SourceReport report;
    report.name = "camera";
    report.hardware_id = depth_.name;
    const std::string trouble = camera_trouble();
    if (!trouble.empty()) {
      report.level = SourceReport::kError;
      report.message = trouble;
    } else {
      report.message = depth_.silence(*clock_) ? "images come" : "unused";
    }
    const ros::SyncCounts sync = sync_counts();
    Values& values = report.values;
    add(values, "publishers of colour images", color_.open() ? color_.publishers() : 0);
    add(values, "publishers of depth images", depth_.publishers());
    add(values, "publishers of camera infos", info_.publishers());
    add(values, "camera sets with equal stamps", sync.exact);
    add(values, "camera sets with near stamps", sync.approximate);
    add(values, "depth images without a colour image", sync.depth_without_color);
    add(values, "depth images without a camera info", sync.depth_without_info);
    add(values, "colour images unused", sync.color_unused);
    add(values, "camera clock restarts", sync.restarts);
    add(values, "ms to the nearest image that was too far",
        static_cast<std::uint64_t>(sync.nearest_miss_ns / 1'000'000));
    wire::ReaderStatistics sum;
    for (const Topic* topic : {&color_, &depth_, &info_}) {
      if (!topic->open()) continue;
      const wire::ReaderStatistics one = topic->statistics();
      sum.received += one.received;
      sum.malformed += one.malformed;
      sum.lost += one.lost;
      sum.incompatible += one.incompatible;
    }
    add(values, "messages of the camera", sum.received);
    add(values, "messages malformed of the camera", sum.malformed);
    add(values, "messages lost by DDS of the camera", sum.lost);
    add(values, "publishers with too weak QoS of the camera", sum.incompatible);
    return report;
  }

  double longest_silence() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return options_.silence_s;
  }

  const wire::Participant& participant_;
  const OnFrame on_frame_;
  const std::shared_ptr<const WaitableClock> clock_;
  const LogHook log_;
  mutable std::mutex mutex_;  ///< Guards the options and the synchronizer.
  InputOptions options_;
  ros::Synchronizer synchronizer_;
  // Last: they call into the members above until they are destroyed.
  Topic frames_, cloud_, color_, depth_, info_;
};

}  // namespace

std::unique_ptr<TopicSource> open_topic_source(const wire::Participant& participant,
                                               const ServerOptions& options, OnFrame on_frame,
                                               std::shared_ptr<const WaitableClock> clock,
                                               LogHook log) {
  return std::make_unique<Topics>(participant, options, std::move(on_frame), std::move(clock),
                                  std::move(log));
}

}  // namespace bpa::server
