// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/load.hpp"

#include <cmath>
#include <csignal>
#include <random>

#include "client/cli/convert.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::soak {
namespace {

constexpr milliseconds kCameraPeriod{100};
constexpr milliseconds kSlow{2000};

void sleep_unless(const std::atomic<bool>& stop, milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (!stop && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(20));
  }
}

wire::sensor_msgs::Image image(const Frame& frame, const std::string& encoding,
                               std::uint32_t pixel_bytes, std::vector<std::uint8_t> data) {
  wire::sensor_msgs::Image image;
  image.width = static_cast<std::uint32_t>(frame.camera.width);
  image.height = static_cast<std::uint32_t>(frame.camera.height);
  image.encoding = encoding;
  image.step = pixel_bytes * image.width;
  image.data = std::move(data);
  return image;
}

wire::sensor_msgs::Image depth_image(const Frame& frame) {
  std::vector<std::uint16_t> mm;
  for (const float z : frame.depth) mm.push_back(static_cast<std::uint16_t>(std::lround(1e3f * z)));
  return image(frame, "16UC1", 2, support::as_bytes(mm));
}

wire::sensor_msgs::CameraInfo camera_info(const Frame& frame) {
  const Camera& c = frame.camera;
  wire::sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(c.width);
  info.height = static_cast<std::uint32_t>(c.height);
  info.distortion_model = "plumb_bob";
  info.d = {0, 0, 0, 0, 0};
  info.k = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0};
  return info;
}

template <class T>
Status open(const wire::Participant& participant, const char* topic,
            std::optional<wire::Publisher<T>>& place) {
  auto publisher = wire::Publisher<T>::create(participant, topic, {wire::qos::sensor_input()});
  if (!publisher.ok()) return publisher.status();
  place.emplace(std::move(publisher).value());
  if (place->wait_for_matched(milliseconds(10000))) return {};
  return {StatusCode::unavailable, std::string("no server takes ") + topic};
}

}  // namespace

Result<std::unique_ptr<CameraLoad>> CameraLoad::create(const std::vector<Frame>& frames) {
  auto participant = support::test_participant("camera");
  if (!participant.ok()) return participant.status();
  std::unique_ptr<CameraLoad> load(new CameraLoad(std::move(participant).value()));
  for (const Frame& frame : frames) {
    load->images_.push_back(
        {image(frame, "rgb8", 3, frame.color), depth_image(frame), camera_info(frame)});
  }
  for (const Status& status : {open(load->participant_, "camera/color", load->color_),
                               open(load->participant_, "camera/depth", load->depth_),
                               open(load->participant_, "camera/info", load->info_)}) {
    if (!status.ok()) return status;
  }
  std::this_thread::sleep_for(milliseconds(500));  // best effort: until the server matched, too
  return load;
}

void CameraLoad::publish() {
  Images& images = images_[frames_ % images_.size()];
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const wire::std_msgs::Header header{
      wire::builtin_interfaces::from_ns(std::chrono::nanoseconds(now).count()), "soak_camera"};
  images.color.header = images.depth.header = images.info.header = header;
  ++frames_;
  messages_ += info_->publish(images.info).ok() ? 1 : 0;
  messages_ += depth_->publish(images.depth).ok() ? 1 : 0;
  messages_ += color_->publish(images.color).ok() ? 1 : 0;
}

void CameraLoad::run(const std::atomic<bool>& stop) {
  auto next = std::chrono::steady_clock::now();
  while (!stop) {
    publish();
    next += kCameraPeriod;
    std::this_thread::sleep_until(next);
  }
}

void RequestLoad::run(const std::vector<Frame>& frames, const std::atomic<bool>& stop) {
  while (!stop) {
    const auto start = std::chrono::steady_clock::now();
    const Frame& own = frames[asked % frames.size()];
    const auto found = asked++ % 2 == 0 ? client.detect() : client.detect_in(cli::view_of(own));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (found.ok()) {
      ++answered;
      detections += found->best().size();
      milliseconds_each.push_back(took.count());
    } else if (found.status().code == StatusCode::busy) {
      ++refused;
    } else if (found.status().code == StatusCode::timeout) {
      ++timed_out;
    } else {
      ++other[found.status().message];
    }
  }
}

void ModelLoad::run(const std::string& model, const std::atomic<bool>& stop) {
  while (!stop) {
    for (const bool load : {true, false}) {
      const Status status =
          load ? client.load_model(model, "soak_extra") : client.unload_model("soak_extra");
      if (!status.ok()) ++failures[status.message];
      sleep_unless(stop, milliseconds(1000));
    }
    ++loads;
  }
}

Result<std::unique_ptr<SlowReader>> SlowReader::create() {
  auto participant = support::test_participant("slow_reader");
  if (!participant.ok()) return participant.status();
  std::unique_ptr<SlowReader> reader(new SlowReader(std::move(participant).value()));
  auto subscriber = wire::Subscriber<wire::vision_msgs::Detection3DArray>::create(
      reader->participant_, "detections", {wire::qos::results()},
      [raw = reader.get()](wire::vision_msgs::Detection3DArray&&, const wire::SampleMeta&) {
        std::this_thread::sleep_for(kSlow);
        ++raw->read_;
      });
  if (!subscriber.ok()) return subscriber.status();
  reader->subscriber_.emplace(std::move(subscriber).value());
  return reader;
}

void KilledClients::run(const std::atomic<bool>& stop) {
  std::minstd_rand random(1);
  for (; !stop; ++killed) {
    const bool asks = killed % 2 == 0;
    const support::Process client(
        {BPA_BINARY_DIR "/bin/bpa-client", "--localhost", "--namespace", support::test_namespace(),
         "--domain", std::to_string(support::test_domain()), asks ? "detect" : "watch"});
    requests += asks ? 1 : 0;
    sleep_unless(stop, milliseconds(1000 + random() % 2000));
    client.signal(SIGKILL);
  }
}

}  // namespace bpa::soak
