// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// One-way latency between two processes of this machine, from before publish() to inside the
// callback, message decoded. Usage: wire_latency [SAMPLES [RATE_HZ]]. Lines: what, then median, 99
// %, maximum in ms, and how many came.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"
#include "tests/support/child_process.hpp"

namespace {

using namespace bpa::wire;
using bpa::Result;
using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

/// The publishing time travels in the stamp; both processes read the same monotonic clock.
builtin_interfaces::Time now_stamp() { return builtin_interfaces::from_ns(now_ns()); }

class Latencies {
 public:
  void add(const std_msgs::Header& header) {
    const double ms =
        1e-6 * static_cast<double>(now_ns() - builtin_interfaces::to_ns(header.stamp));
    const std::lock_guard<std::mutex> lock(mutex_);
    ms_.push_back(ms);
  }
  std::size_t count() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return ms_.size();
  }
  void print(const std::string& name, std::size_t sent) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::sort(ms_.begin(), ms_.end());
    if (ms_.empty()) return (void)std::printf("%-34s nothing came\n", name.c_str());
    std::printf("%-34s %8.3f %8.3f %8.3f   %zu of %zu\n", name.c_str(), ms_[ms_.size() / 2],
                ms_[ms_.size() * 99 / 100], ms_.back(), ms_.size(), sent);
    std::fflush(stdout);
  }

 private:
  std::mutex mutex_;
  std::vector<double> ms_;
};

constexpr std::uint32_t kWidth = 640, kHeight = 480;

void pace(Clock::time_point& next, int rate_hz) {
  next += std::chrono::nanoseconds(1'000'000'000 / rate_hz);
  std::this_thread::sleep_until(next);
}

/// Publishes RgbdFrames without copying the images first.
void send_frames(const Participant& participant, const std::string& topic, int samples,
                 int rate_hz) {
  PublisherOptions options;
  options.qos = qos::frames();
  auto publisher = Publisher<bpa_msgs::RgbdFrame>::create(participant, topic, options);
  if (!publisher.ok() || !publisher->wait_for_matched(seconds(10))) return;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const std::vector<std::uint8_t> color(3U * kWidth * kHeight, 7), depth(2U * kWidth * kHeight, 9);
  Clock::time_point next = Clock::now();
  for (int i = 0; i < samples; ++i) {
    pace(next, rate_hz);
    bpa_msgs::RgbdFrameView frame;
    frame.header.stamp = now_stamp();
    frame.width = kWidth;
    frame.height = kHeight;
    frame.color_encoding = "rgb8";
    frame.color = {color.data(), color.size()};
    frame.depth_encoding = "16UC1";
    frame.depth = {depth.data(), depth.size()};
    (void)publisher->publish(frame).ok();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
}

/// Publishes what a ROS 2 camera does: a colour and a depth image, in two messages.
void send_images(const Participant& participant, const std::string& topic, int samples,
                 int rate_hz) {
  PublisherOptions options;
  options.qos = qos::frames();
  auto color = Publisher<sensor_msgs::Image>::create(participant, topic + "/color", options);
  auto depth = Publisher<sensor_msgs::Image>::create(participant, topic + "/depth", options);
  if (!color.ok() || !depth.ok()) return;
  if (!color->wait_for_matched(seconds(10)) || !depth->wait_for_matched(seconds(10))) return;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  sensor_msgs::Image color_image, depth_image;
  color_image.width = depth_image.width = kWidth;
  color_image.height = depth_image.height = kHeight;
  color_image.encoding = "rgb8";
  color_image.step = 3 * kWidth;
  color_image.data.assign(std::size_t{color_image.step} * kHeight, 7);
  depth_image.encoding = "16UC1";
  depth_image.step = 2 * kWidth;
  depth_image.data.assign(std::size_t{depth_image.step} * kHeight, 9);
  Clock::time_point next = Clock::now();
  for (int i = 0; i < samples; ++i) {
    pace(next, rate_hz);
    color_image.header.stamp = depth_image.header.stamp = now_stamp();
    (void)color->publish(color_image).ok();
    (void)depth->publish(depth_image).ok();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
}

int send_all(int domain, int samples, int rate_hz) {
  auto participant = test_participant("latency_sender", {}, domain);
  if (!participant.ok()) return 1;
  send_frames(*participant, "/frames", samples, rate_hz);
  send_images(*participant, "/best_effort", samples, rate_hz);
  send_images(*participant, "/reliable", samples, rate_hz);
  return 0;
}

template <class T>
Result<Subscriber<T>> listen(const Participant& participant, const std::string& topic,
                             const Qos& qos, Latencies& latencies) {
  SubscriberOptions options;
  options.qos = qos;
  return Subscriber<T>::create(
      participant, topic, options,
      [&latencies](T&& message, const SampleMeta&) { latencies.add(message.header); });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::string(argv[1]) == "--send") {
    return send_all(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
  }
  const int samples = argc > 1 ? std::atoi(argv[1]) : 300;
  const int rate_hz = argc > 2 ? std::atoi(argv[2]) : 30;
  const int domain = 1 + getpid() % 100;
  auto participant = test_participant("latency_receiver", {}, domain);
  if (!participant.ok()) return 1;
  Latencies frames, color_best_effort, best_effort, color_reliable, reliable;
  using Frame = bpa_msgs::RgbdFrame;
  using Image = sensor_msgs::Image;
  const auto b = listen<Frame>(*participant, "/frames", qos::reliable_input(), frames);
  const auto c =
      listen<Image>(*participant, "/best_effort/color", qos::sensor_input(), color_best_effort);
  const auto d =
      listen<Image>(*participant, "/best_effort/depth", qos::sensor_input(), best_effort);
  const auto e =
      listen<Image>(*participant, "/reliable/color", qos::reliable_input(), color_reliable);
  const auto f = listen<Image>(*participant, "/reliable/depth", qos::reliable_input(), reliable);
  bpa::ChildProcess sender({argv[0], "--send", std::to_string(domain), std::to_string(samples),
                            std::to_string(rate_hz)});
  const int code = sender.finish(seconds(60 + 8 * samples / rate_hz));
  const auto sent = static_cast<std::size_t>(samples);
  std::printf("%d Hz, 640x480                       median     99 %%      max\n", rate_hz);
  frames.print("RgbdFrame 1.5 MB, reliable", sent);
  color_best_effort.print("Image colour, best effort", sent);
  best_effort.print("  and depth: the pair", sent);
  color_reliable.print("Image colour, reliable", sent);
  reliable.print("  and depth: the pair", sent);
  return code;
}
