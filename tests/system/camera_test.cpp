// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/depth_codecs.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

// A ROS 2 style camera in this process (three best-effort topics), the server in another one.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::CompressedImage;

constexpr std::int64_t kMs = 1'000'000;

class CameraTopics : public testing::Test {
 protected:
  void start(const std::vector<std::string>& more = {}, bool raw = true) {
    std::vector<std::string> settings = {"input.color=camera/color", "input.depth=camera/depth",
                                         "input.camera_info=camera/info", "queue.frames=50"};
    settings.insert(settings.end(), more.begin(), more.end());
    server = std::make_unique<support::StubServer>(settings);
    auto seat = support::test_participant("camera");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
    open("camera/color", color);
    open("camera/depth", depth);
    open("camera/info", info);
    wire::SubscriberOptions options;
    options.qos = wire::qos::results();
    auto subscriber = wire::Subscriber<wire::bpa_msgs::SceneInterpretations>::create(
        *participant, "interpretations", options,
        [this](wire::bpa_msgs::SceneInterpretations&& message, const wire::SampleMeta&) {
          const std::lock_guard<std::mutex> lock(mutex);
          const std::int64_t stamp = to_ns(message.header.stamp);
          results[stamp] = std::move(message);
          changed.notify_all();
        });
    ASSERT_TRUE(subscriber.ok());
    results_in.emplace(std::move(subscriber).value());
    ASSERT_TRUE(results_in->wait_for_matched(milliseconds(10000))) << server->log();
    if (raw) {
      ASSERT_TRUE(depth->wait_for_matched(milliseconds(10000)));
      ASSERT_TRUE(color->wait_for_matched(milliseconds(10000)));
    }
    ASSERT_TRUE(info->wait_for_matched(milliseconds(10000)));
    std::this_thread::sleep_for(milliseconds(300));  // best effort: until the server matched, too
  }
  template <class T>
  void open(const char* topic, std::optional<wire::Publisher<T>>& place) {
    wire::PublisherOptions options;
    options.qos = {wire::Reliability::best_effort, wire::Durability::volatile_, 5, 0};
    auto publisher = wire::Publisher<T>::create(*participant, topic, options);
    ASSERT_TRUE(publisher.ok()) << publisher.status().message;
    place.emplace(std::move(publisher).value());
  }
  bool wait_for(std::size_t count, milliseconds time = milliseconds(10000)) {
    std::unique_lock<std::mutex> lock(mutex);
    return changed.wait_for(lock, time, [&] { return results.size() >= count; });
  }
  std::map<std::string, std::string> details() {
    auto client = Client::connect(support::client_options());
    if (!client.ok()) return {};
    const auto status = client->status();
    if (!status.ok()) return {};
    return {status->details.begin(), status->details.end()};
  }

  /// What the next diagnostics say of the camera.
  wire::diagnostic_msgs::DiagnosticStatus camera_status() {
    std::mutex status_mutex;
    std::condition_variable came;
    std::optional<wire::diagnostic_msgs::DiagnosticStatus> status;
    const auto subscriber = wire::Subscriber<wire::diagnostic_msgs::DiagnosticArray>::create(
        *participant, "diagnostics", {},
        [&](wire::diagnostic_msgs::DiagnosticArray&& message, const wire::SampleMeta&) {
          const std::lock_guard<std::mutex> lock(status_mutex);
          for (auto& one : message.status) {
            if (one.name.find(": camera") != std::string::npos) status = std::move(one);
          }
          came.notify_all();
        });
    std::unique_lock<std::mutex> lock(status_mutex);
    came.wait_for(lock, milliseconds(10000), [&] { return status.has_value(); });
    return status.value_or(wire::diagnostic_msgs::DiagnosticStatus());
  }

  std::unique_ptr<support::StubServer> server;
  std::optional<wire::Participant> participant;
  std::optional<wire::Publisher<wire::sensor_msgs::Image>> color, depth;
  std::optional<wire::Publisher<CameraInfo>> info;
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::int64_t, wire::bpa_msgs::SceneInterpretations> results;
  std::optional<wire::Subscriber<wire::bpa_msgs::SceneInterpretations>> results_in;
};

TEST_F(CameraTopics, ExactAndNearStampsAreSearchedWithTheDepthImagesStamp) {
  start();
  for (int i = 0; i < 10; ++i) {
    const std::int64_t stamp = (1000 + 33 * i) * kMs;
    const std::int64_t late = i % 2 == 0 ? 0 : 4 * kMs;  // every other colour image
    ASSERT_TRUE(info->publish(support::wall_camera_info(stamp)).ok());
    ASSERT_TRUE(depth->publish(support::wall_depth_image(stamp)).ok());
    ASSERT_TRUE(color->publish(support::wall_color_image(stamp + late)).ok());
    std::this_thread::sleep_for(milliseconds(20));
  }
  ASSERT_TRUE(wait_for(10)) << results.size() << server->log();
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_EQ(results.begin()->first, 1000 * kMs);
  for (const auto& [stamp, result] : results) {
    EXPECT_EQ(result.status.code, 0) << result.status.message;
    EXPECT_EQ(result.header.frame_id, "wall_camera");
    EXPECT_NEAR(result.interpretations.at(0).placements.at(0).pose.pose.position.z, 0.788, 1e-6);
  }
  const auto counts = details();
  EXPECT_EQ(counts.at("camera sets with equal stamps"), "5");
  EXPECT_EQ(counts.at("camera sets with near stamps"), "5");
}

TEST_F(CameraTopics, OtherEncodingsGiveTheSameDepth) {
  start();
  // Big-endian millimetres with padded rows, bgra colour.
  wire::sensor_msgs::Image image = support::wall_depth_image(1000 * kMs);
  const std::vector<std::uint8_t> little = image.data;
  image.is_bigendian = 1;
  image.step = 2 * support::kWidth + 6;
  image.data.assign(image.step * support::kHeight, 0xff);
  for (std::size_t v = 0; v < support::kHeight; ++v) {
    for (std::size_t u = 0; u < support::kWidth; ++u) {
      const std::size_t from = 2 * (v * support::kWidth + u);
      image.data[v * image.step + 2 * u] = little[from + 1];
      image.data[v * image.step + 2 * u + 1] = little[from];
    }
  }
  wire::sensor_msgs::Image bgra = support::wall_color_image(1000 * kMs);
  bgra.encoding = "bgra8";
  bgra.step = 4 * support::kWidth;
  bgra.data.assign(bgra.step * support::kHeight, 9);
  ASSERT_TRUE(info->publish(support::wall_camera_info(1000 * kMs)).ok());
  ASSERT_TRUE(color->publish(bgra).ok());
  ASSERT_TRUE(depth->publish(image).ok());
  ASSERT_TRUE(wait_for(1)) << server->log();
  // Metres.
  image = support::wall_depth_image(1033 * kMs);
  std::vector<float> metres;
  for (const std::uint16_t mm : support::wall_depth_mm()) {
    metres.push_back(static_cast<float>(mm * 0.001));
  }
  image.encoding = "32FC1";
  image.step = 4 * support::kWidth;
  image.data = support::as_bytes(metres);
  ASSERT_TRUE(info->publish(support::wall_camera_info(1033 * kMs)).ok());
  ASSERT_TRUE(color->publish(support::wall_color_image(1033 * kMs)).ok());
  ASSERT_TRUE(depth->publish(image).ok());
  ASSERT_TRUE(wait_for(2)) << server->log();
  const std::lock_guard<std::mutex> lock(mutex);
  for (const auto& [stamp, result] : results) {
    ASSERT_EQ(result.status.code, 0) << result.status.message;
    EXPECT_EQ(result.interpretations.at(0).placements.at(0).pose.pose.position.z,
              static_cast<double>(static_cast<float>(788 * 0.001)));
  }
}

/// As a camera driver with image_transport: the plugins' topics stand below the raw ones.
TEST_F(CameraTopics, CompressedTransportsGiveTheSameDepth) {
  for (const bool rvl : {false, true}) {
    results.clear();
    start({"input.color_transport=compressed", "input.depth_transport=compressedDepth"}, false);
    std::optional<wire::Publisher<CompressedImage>> packed_color, packed_depth;
    open("camera/color/compressed", packed_color);
    open("camera/depth/compressedDepth", packed_depth);
    ASSERT_TRUE(packed_color->wait_for_matched(milliseconds(10000))) << server->log();
    ASSERT_TRUE(packed_depth->wait_for_matched(milliseconds(10000)));
    std::this_thread::sleep_for(milliseconds(300));
    ASSERT_TRUE(info->publish(support::wall_camera_info(1000 * kMs)).ok());
    ASSERT_TRUE(packed_color->publish(support::compressed_color(1000 * kMs)).ok());
    ASSERT_TRUE(packed_depth->publish(support::compressed_depth(1000 * kMs, rvl)).ok());
    ASSERT_TRUE(wait_for(1)) << server->log();
    const std::lock_guard<std::mutex> lock(mutex);
    const auto& result = results.begin()->second;
    ASSERT_EQ(result.status.code, 0) << result.status.message;
    EXPECT_EQ(result.interpretations.at(0).placements.at(0).pose.pose.position.z,
              static_cast<double>(static_cast<float>(788 * 0.001)));
  }
}

TEST_F(CameraTopics, ACameraThatFallsSilentIsReported) {
  start({"input.silence_s=0.5"});
  EXPECT_EQ(camera_status().level, wire::diagnostic_msgs::DiagnosticStatus::kOk);  // unused
  ASSERT_TRUE(info->publish(support::wall_camera_info(1000 * kMs)).ok());
  ASSERT_TRUE(color->publish(support::wall_color_image(1000 * kMs)).ok());
  ASSERT_TRUE(depth->publish(support::wall_depth_image(1000 * kMs)).ok());
  ASSERT_TRUE(wait_for(1)) << server->log();
  std::this_thread::sleep_for(milliseconds(600));
  const auto status = camera_status();
  EXPECT_EQ(status.level, wire::diagnostic_msgs::DiagnosticStatus::kError);
  EXPECT_NE(status.message.find("the camera is gone"), std::string::npos) << status.message;
}

TEST_F(CameraTopics, StreamsThatDoNotFitAreCountedAndSaid) {
  start();
  for (int i = 0; i < 40; ++i) {
    const std::int64_t stamp = (1000 + 33 * i) * kMs;
    ASSERT_TRUE(info->publish(support::wall_camera_info(stamp)).ok());
    ASSERT_TRUE(depth->publish(support::wall_depth_image(stamp)).ok());
    ASSERT_TRUE(color->publish(support::wall_color_image(stamp + 16 * kMs)).ok());
    std::this_thread::sleep_for(milliseconds(10));
  }
  std::this_thread::sleep_for(milliseconds(1500));  // the server reports once a second
  {
    const std::lock_guard<std::mutex> lock(mutex);
    EXPECT_TRUE(results.empty());
  }
  const auto counts = details();
  EXPECT_GE(std::stoi(counts.at("depth images without a colour image")), 30);
  EXPECT_EQ(counts.at("camera sets with near stamps"), "0");
  EXPECT_NE(server->log().find("without a colour image"), std::string::npos) << server->log();
  EXPECT_NE(server->log().find("16 ms away"), std::string::npos) << server->log();
}

TEST_F(CameraTopics, UnregisteredDepthIsRefusedByName) {
  start();
  wire::sensor_msgs::Image small = support::wall_color_image(1000 * kMs);
  small.width = 32;
  small.step = 96;
  small.data.resize(96 * support::kHeight);
  ASSERT_TRUE(info->publish(support::wall_camera_info(1000 * kMs)).ok());
  ASSERT_TRUE(color->publish(small).ok());
  ASSERT_TRUE(depth->publish(support::wall_depth_image(1000 * kMs)).ok());
  ASSERT_TRUE(wait_for(1)) << server->log();
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_NE(results.begin()->second.status.message.find("registered"), std::string::npos);
}

}  // namespace
}  // namespace bpa
