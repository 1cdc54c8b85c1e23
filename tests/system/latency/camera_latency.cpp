// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Frame in to result out with detection replaced by a no-op: a camera as a ROS 2 driver sends it
// (colour and depth of 640x480 and the camera info, over UDP), bpa-stub-server in another process,
// its interpretations back here. Then the same with Fast DDS as it comes, and from the SDK.
// Usage: camera_latency [FRAMES [RATE_HZ]]. By hand: 10000 frames take 3 x 333 s.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/stub_server.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using namespace bpa;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::Image;

constexpr std::uint32_t kWidth = 640, kHeight = 480;
constexpr int kWarmUp = 100;

/// When each frame left and came back, by its stamp.
class Trips {
 public:
  void leave(std::int64_t stamp) {
    const std::lock_guard<std::mutex> lock(mutex_);
    left_[stamp] = Clock::now();
  }
  void arrive(std::int64_t stamp) {
    const auto now = Clock::now();
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto left = left_.find(stamp);
    if (left == left_.end()) return;
    if (stamp > kWarmUp) {
      ms_.push_back(std::chrono::duration<double, std::milli>(now - left->second).count());
    }
    left_.erase(left);
  }
  void print(const char* name, int frames, const ServerStatus& before, const ServerStatus& after) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::sort(ms_.begin(), ms_.end());
    const auto at = [this](double share) {
      return ms_.empty() ? -1 : ms_[static_cast<std::size_t>(share * (ms_.size() - 1))];
    };
    std::printf("%-34s %7.2f %7.2f %7.2f %7.2f   %zu of %d lost, memory %.1f -> %.1f MB\n", name,
                at(0), at(0.5), at(0.99), at(1), static_cast<std::size_t>(frames) - ms_.size(),
                frames, 1e-6 * static_cast<double>(before.memory_bytes),
                1e-6 * static_cast<double>(after.memory_bytes));
    std::fflush(stdout);
  }

 private:
  std::mutex mutex_;
  std::map<std::int64_t, Clock::time_point> left_;
  std::vector<double> ms_;
};

/// Sends frames 1, 2, ... at the rate; the first ones warm up, after which memory is read.
template <class Send>
void run(const char* name, int frames, int rate_hz, Client& client, Trips& trips, Send send) {
  std::this_thread::sleep_for(milliseconds(500));
  ServerStatus before;
  auto next = Clock::now();
  for (std::int64_t stamp = 1; stamp <= frames + kWarmUp; ++stamp) {
    next += std::chrono::nanoseconds(1'000'000'000 / rate_hz);
    std::this_thread::sleep_until(next);
    if (stamp == kWarmUp + 1) {
      if (auto status = client.status(); status.ok()) before = *status;
      next = Clock::now();
    }
    trips.leave(stamp);
    send(stamp);
  }
  std::this_thread::sleep_for(milliseconds(1000));
  ServerStatus after;
  if (auto status = client.status(); status.ok()) after = *status;
  trips.print(name, frames, before, after);
}

struct CameraFrames {
  Image color, depth;
  CameraInfo info;

  CameraFrames() {
    color.width = depth.width = info.width = kWidth;
    color.height = depth.height = info.height = kHeight;
    color.encoding = "rgb8";
    color.step = 3 * kWidth;
    color.data.assign(std::size_t{color.step} * kHeight, 90);
    depth.encoding = "16UC1";
    depth.step = 2 * kWidth;
    depth.data.assign(std::size_t{depth.step} * kHeight, 3);
    info.k = {525, 0, 319.5, 0, 525, 239.5, 0, 0, 1};
  }
  void set_stamp(std::int64_t stamp) {
    color.header.stamp = depth.header.stamp = info.header.stamp =
        wire::builtin_interfaces::from_ns(stamp);
  }
};

wire::Participant seat(const std::string& name, const std::string& profiles) {
  wire::ParticipantOptions options;
  options.node = {support::test_namespace(), name};
  wire::Discovery discovery;
  discovery.domain_id = support::test_domain();
  discovery.range = wire::DiscoveryRange::localhost;
  options.discovery = discovery;
  options.profiles = profiles;
  return wire::Participant::create(std::move(options)).value();
}

int camera(const char* name, int frames, int rate_hz, const std::string& profiles) {
  support::StubServer server({"input.color=color", "input.depth=depth", "input.camera_info=info",
                              "queue.frames=10", "network.profiles='" + profiles + "'"});
  auto client = Client::connect(support::client_options());
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().message.c_str()), 1;
  const wire::Participant participant = seat("camera", profiles);
  Trips trips;
  wire::SubscriberOptions subscription;
  subscription.qos = wire::qos::results();
  const auto results = wire::Subscriber<wire::bpa_msgs::SceneInterpretations>::create(
      participant, "interpretations", subscription,
      [&trips](wire::bpa_msgs::SceneInterpretations&& message, const wire::SampleMeta&) {
        trips.arrive(to_ns(message.header.stamp));
      });
  auto color = wire::Publisher<Image>::create(participant, "color");
  auto depth = wire::Publisher<Image>::create(participant, "depth");
  auto info = wire::Publisher<CameraInfo>::create(participant, "info");
  if (!results.ok() || !color.ok() || !depth.ok() || !info.ok()) return 1;
  if (!depth->wait_for_matched(milliseconds(10000)) ||
      !results->wait_for_matched(milliseconds(10000))) {
    return std::fprintf(stderr, "nobody listens\n%s", server.log().c_str()), 1;
  }
  CameraFrames images;
  run(name, frames, rate_hz, *client, trips, [&](std::int64_t stamp) {
    images.set_stamp(stamp);
    (void)info->publish(images.info).ok();
    (void)color->publish(images.color).ok();
    (void)depth->publish(images.depth).ok();
  });
  return 0;
}

int sdk(const char* name, int frames, int rate_hz) {
  support::StubServer server({"queue.frames=10"});
  Trips trips;
  auto client = Client::connect(support::client_options());
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().message.c_str()), 1;
  if (!client->subscribe([&](const DetectionSet& set) { trips.arrive(set.stamp_ns); }).ok())
    return 1;
  const CameraFrames images;
  const std::vector<std::uint16_t> depth(kWidth * kHeight, 900);
  FrameView frame;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.rgb = images.color.data.data();
  frame.depth_mm = depth.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;
  run(name, frames, rate_hz, *client, trips, [&](std::int64_t stamp) {
    frame.stamp_ns = stamp;
    (void)client->publish_frame(frame).ok();
  });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 300;
  const int rate_hz = argc > 2 ? std::atoi(argv[2]) : 30;
  const std::string only = argc > 3 ? argv[3] : "";
  std::printf("%d Hz, 640x480                       min  median    99 %%     max  (ms)\n", rate_hz);
  int code = 0;
  if (only.empty() || only == "sdk") code |= sdk("SDK", frames, rate_hz);
  if (only.empty() || only == "camera") code |= camera("camera topics, UDP", frames, rate_hz, "");
  // Last: the profiles stay with the process.
  if (only.empty() || only == "defaults") {
    code |= camera("the same with Fast DDS's defaults", frames, rate_hz,
                   BPA_SOURCE_DIR "/tests/system/latency/fastdds_defaults.xml");
  }
  return code;
}
