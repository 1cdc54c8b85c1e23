// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <condition_variable>
#include <iostream>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// Frames published by the SDK, results in another process.

namespace bpa {
namespace {

using std::chrono::milliseconds;

/// What came, by whatever the test calls it; waits for it.
template <class T>
class Arrivals {
 public:
  void add(T item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.push_back(std::move(item));
    changed_.notify_all();
  }
  bool wait_for(std::size_t count, milliseconds time = milliseconds(10000)) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, time, [&] { return items_.size() >= count; });
  }
  std::vector<T> items() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> items_;
};

class StreamOfFrames : public testing::Test, protected support::WallView {};

TEST_F(StreamOfFrames, EveryFrameComesBackWithItsStamp) {
  support::StubServer server({"queue.frames=30"});
  Arrivals<DetectionSet> results;
  Arrivals<AnnotatedImage> images;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message << server.log();
  ASSERT_TRUE(client->subscribe([&](const DetectionSet& set) { results.add(set); }).ok());
  ASSERT_TRUE(
      client->subscribe_annotated([&](const AnnotatedImage& image) { images.add(image); }).ok());
  for (int i = 1; i <= 20; ++i) {
    ASSERT_TRUE(client->publish_frame(view(i * 1'000'000'007LL)).ok());
    ASSERT_TRUE(results.wait_for(static_cast<std::size_t>(i))) << i << server.log();
  }
  ASSERT_TRUE(images.wait_for(20));
  for (int i = 1; i <= 20; ++i) {
    const DetectionSet set = results.items()[static_cast<std::size_t>(i - 1)];
    EXPECT_TRUE(set.status.ok());
    EXPECT_EQ(set.stamp_ns, i * 1'000'000'007LL);
    EXPECT_EQ(set.frame_id, "wall");
    EXPECT_EQ(set.best().size(), 1U);
  }
  EXPECT_EQ(images.items()[3].stamp_ns, 4 * 1'000'000'007LL);
  EXPECT_EQ(images.items()[3].rgb, std::vector<std::uint8_t>(rgb.size(), 200));
}

TEST_F(StreamOfFrames, ASlowSearchDropsOldFramesAndCountsThem) {
  support::StubServer server({}, 150);
  Arrivals<DetectionSet> results;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet& set) { results.add(set); }).ok());
  constexpr int kSent = 20;
  for (int i = 1; i <= kSent; ++i) {
    ASSERT_TRUE(client->publish_frame(view(i)).ok());
    std::this_thread::sleep_for(milliseconds(20));
  }
  ASSERT_TRUE(results.wait_for(2));
  Result<ServerStatus> status = client->status();
  for (int i = 0; i < 50 && status.ok(); ++i) {
    if (status->frames_processed + status->frames_dropped == kSent) break;
    std::this_thread::sleep_for(milliseconds(50));
    status = client->status();
  }
  ASSERT_TRUE(status.ok()) << status.status().message;
  EXPECT_EQ(status->frames_received, static_cast<std::uint64_t>(kSent));
  EXPECT_EQ(status->frames_processed + status->frames_dropped, static_cast<std::uint64_t>(kSent));
  EXPECT_GT(status->frames_dropped, 5U);
  EXPECT_EQ(results.items().back().stamp_ns, kSent);  // the newest wins
}

TEST_F(StreamOfFrames, FramesOfAStillSceneAreCombinedAndOthersBeginAnew) {
  support::StubServer server({"detection.fuse_frames=3"});
  Arrivals<DetectionSet> results;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet& set) { results.add(set); }).ok());
  std::vector<std::uint16_t> shifted = depth;
  std::size_t sent = 0;
  // The stub says how deep the middle is, once the frame before has been searched.
  const auto middle_of = [&](int shift_mm, double fx, int* fused) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
      shifted[i] = static_cast<std::uint16_t>(depth[i] + shift_mm);
    }
    FrameView frame = view(static_cast<std::int64_t>(++sent));
    frame.depth_mm = shifted.data();
    frame.fx = fx;
    EXPECT_TRUE(client->publish_frame(frame).ok());
    EXPECT_TRUE(results.wait_for(sent)) << server.log();
    const DetectionSet set = results.items().back();
    EXPECT_EQ(set.stamp_ns, static_cast<std::int64_t>(sent));
    *fused = set.fused_frames;
    return set.best().at(0).camera_from_object.position[2];
  };
  int fused = 0;
  const double start = middle_of(0, 60, &fused);
  EXPECT_EQ(fused, 1);
  EXPECT_NEAR(middle_of(3, 60, &fused), start + 0.0015, 1e-6);
  EXPECT_EQ(fused, 2);
  EXPECT_NEAR(middle_of(3, 60, &fused), start + 0.002, 1e-6);
  EXPECT_EQ(fused, 3);
  EXPECT_NEAR(middle_of(0, 60, &fused), start + 0.002, 1e-6) << "of the last three";
  EXPECT_EQ(fused, 3);
  EXPECT_NEAR(middle_of(100, 60, &fused), start + 0.1, 1e-6);
  EXPECT_EQ(fused, 1);
  EXPECT_NEAR(middle_of(102, 60, &fused), start + 0.101, 1e-6);
  EXPECT_EQ(fused, 2);
  EXPECT_NEAR(middle_of(102, 61, &fused), start + 0.102, 1e-6);
  EXPECT_EQ(fused, 1);
  const std::string log = server.log();
  EXPECT_NE(log.find("frames are combined anew: 100 % of the depths changed"), std::string::npos)
      << log;
  EXPECT_NE(log.find("camera.fx changed from 60 to 61"), std::string::npos) << log;
  const auto status = client->status();
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(status->frames_processed, sent);

  // A request with a frame of its own is about that frame alone.
  const auto own = client->detect_in(view(9));
  ASSERT_TRUE(own.ok()) << own.status().message;
  EXPECT_EQ(own->fused_frames, 1);
  EXPECT_EQ(own->best().at(0).camera_from_object.position[2], start);
}

TEST_F(StreamOfFrames, ABadFrameIsReportedToSubscribersAndForgotten) {
  support::StubServer server;
  Arrivals<DetectionSet> results;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet& set) { results.add(set); }).ok());
  FrameView bad = view(5);
  bad.fx = 0;
  ASSERT_TRUE(client->publish_frame(bad).ok());
  ASSERT_TRUE(results.wait_for(1));
  EXPECT_EQ(results.items()[0].status.code, StatusCode::invalid_argument);
  EXPECT_NE(results.items()[0].status.message.find("fx"), std::string::npos);
  EXPECT_EQ(results.items()[0].stamp_ns, 5);
  ASSERT_TRUE(client->publish_frame(view(6)).ok());
  ASSERT_TRUE(results.wait_for(2));
  EXPECT_TRUE(results.items()[1].status.ok());
  const auto status = client->status();
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(status->frames_rejected, 1U);
  EXPECT_NE(server.log().find("fx"), std::string::npos);

  bad = view(7);
  bad.depth_mm = nullptr;
  EXPECT_EQ(client->publish_frame(bad).code, StatusCode::invalid_argument);
}

TEST_F(StreamOfFrames, AClientSurvivesAServerThatRestarts) {
  support::StubServer server;
  Arrivals<DetectionSet> results;
  ClientOptions options = support::client_options();
  auto client = Client::connect(options);
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet& set) { results.add(set); }).ok());
  ASSERT_TRUE(client->publish_frame(view(1)).ok());
  ASSERT_TRUE(results.wait_for(1));

  server.process().signal(SIGTERM);
  ASSERT_EQ(server.process().wait(milliseconds(5000)), 0);
  server.start();
  const auto models = client->models();
  ASSERT_TRUE(models.ok()) << models.status().message;
  const auto found = client->detect_in(view(2));
  ASSERT_TRUE(found.ok()) << found.status().message;
  // The stream as well: frames reach the new server and its results come here.
  for (int i = 0; i < 20 && results.items().size() < 2; ++i) {
    ASSERT_TRUE(client->publish_frame(view(10 + i)).ok());
    results.wait_for(2, milliseconds(250));
  }
  EXPECT_GE(results.items().size(), 2U);
}

TEST_F(StreamOfFrames, StandardTopicsCarryTheSameResult) {
  support::StubServer server;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  auto participant = support::test_participant("listener");
  ASSERT_TRUE(participant.ok());
  Arrivals<wire::vision_msgs::Detection3DArray> detections;
  Arrivals<wire::visualization_msgs::MarkerArray> markers;
  Arrivals<wire::tf2_msgs::TFMessage> transforms;
  Arrivals<wire::vision_msgs::VisionInfo> infos;
  Arrivals<wire::diagnostic_msgs::DiagnosticArray> diagnostics;
  const auto listen = [&](const char* topic, wire::Qos qos, auto& arrivals, auto tag) {
    using Message = decltype(tag);
    wire::SubscriberOptions options;
    options.qos = qos;
    return wire::Subscriber<Message>::create(
        *participant, topic, options,
        [&arrivals](Message&& m, const wire::SampleMeta&) { arrivals.add(std::move(m)); });
  };
  const auto s1 =
      listen("detections", wire::qos::results(), detections, wire::vision_msgs::Detection3DArray());
  const auto s2 =
      listen("markers", wire::qos::results(), markers, wire::visualization_msgs::MarkerArray());
  const auto s3 = listen("tf", wire::qos::transforms(), transforms, wire::tf2_msgs::TFMessage());
  const auto s4 =
      listen("vision_info", wire::qos::latched(), infos, wire::vision_msgs::VisionInfo());
  const auto s5 = listen("diagnostics", wire::qos::results(), diagnostics,
                         wire::diagnostic_msgs::DiagnosticArray());
  ASSERT_TRUE(s1.ok() && s2.ok() && s3.ok() && s4.ok() && s5.ok());
  for (int i = 0; i < 40 && (detections.items().empty() || transforms.items().empty() ||
                             markers.items().empty());
       ++i) {
    ASSERT_TRUE(client->publish_frame(view(77'000'000'123)).ok());
    detections.wait_for(1, milliseconds(250));
  }
  ASSERT_TRUE(detections.wait_for(1));
  const auto detection = detections.items()[0];
  EXPECT_EQ(to_ns(detection.header.stamp), 77'000'000'123);
  EXPECT_EQ(detection.header.frame_id, "wall");
  ASSERT_EQ(detection.detections.size(), 1U);
  EXPECT_EQ(detection.detections[0].results.at(0).hypothesis.class_id, "stub");
  ASSERT_TRUE(markers.wait_for(1));
  EXPECT_EQ(markers.items()[0].markers.size(), 3U);
  ASSERT_TRUE(transforms.wait_for(1));
  EXPECT_EQ(transforms.items()[0].transforms.at(0).child_frame_id,
            support::test_namespace().substr(1) + "/stub_0");
  ASSERT_TRUE(infos.wait_for(1));  // latched: sent before we came
  EXPECT_EQ(infos.items()[0].database_location, "stub");
  ASSERT_TRUE(diagnostics.wait_for(1));
  std::set<std::string> names;
  const auto last_diagnostics = diagnostics.items().back();
  for (const auto& status : last_diagnostics.status) {
    EXPECT_EQ(status.level, wire::diagnostic_msgs::DiagnosticStatus::kOk) << status.message;
    names.insert(status.name.substr(status.name.find(": ") + 2));
  }
  EXPECT_EQ(names, (std::set<std::string>{"detection", "drops", "queue", "models", "frames",
                                          "camera", "tracking"}));
}

}  // namespace
}  // namespace bpa
