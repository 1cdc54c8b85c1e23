// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/latest.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// Tracks of a server in another process, whose tracker keeps what the search finds.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using support::Latest;

bool has_one(const TrackSet& set) { return set.tracks.size() == 1; }

class TracksOfFrames : public testing::Test, protected support::WallView {
 protected:
  ~TracksOfFrames() override { stop_frames(); }

  void connect(const support::StubServer& server) {
    auto connected = Client::connect(support::client_options());
    ASSERT_TRUE(connected.ok()) << connected.status().message << server.log();
    client_.emplace(std::move(connected).value());
  }
  void subscribe() {
    ASSERT_TRUE(client_->tracks([this](const TrackSet& set) { sets_.add(set); }).ok());
  }
  /// Sends frames until the test ends, each with a stamp of its own.
  void send_frames() {
    sender_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (client_->publish_frame(view(1'000'000'000 + 20'000'000 * ++sent_)).ok()) {
          std::this_thread::sleep_for(milliseconds(20));
        }
      }
    });
  }
  void stop_frames() {
    if (sender_.joinable()) {
      sender_.request_stop();
      sender_.join();
    }
  }
  /// The numbers of get_status's details by their names.
  std::map<std::string, std::uint64_t> details() {
    std::map<std::string, std::uint64_t> numbers;
    const auto status = client_->status();
    EXPECT_TRUE(status.ok()) << status.status().message;
    if (!status.ok()) return numbers;
    for (const auto& [key, value] : status->details) {
      numbers[key] = std::strtoull(value.c_str(), nullptr, 10);
    }
    return numbers;
  }
  /// Waits until all frames that came are followed or counted by the cause why not.
  void expect_all_accounted_for() {
    std::uint64_t received = 0, sum = 1;
    for (int i = 0; i < 100 && received != sum; ++i) {
      std::this_thread::sleep_for(milliseconds(50));
      sum = 0;
      for (const auto& [key, value] : details()) {
        if (key == "frames to follow received") received = value;
        if (key == "frames followed" || key.rfind("frames not followed: ", 0) == 0) sum += value;
      }
    }
    EXPECT_EQ(received, sum);
    EXPECT_EQ(received, static_cast<std::uint64_t>(sent_));
  }

  Latest<TrackSet> sets_;
  std::optional<Client> client_;  ///< Calls back until it is destroyed.
  std::atomic<std::int64_t> sent_{0};
  std::jthread sender_;
};

TEST_F(TracksOfFrames, KeepTheirIdsWhileTheSearchIsSlow) {
  support::StubServer server({}, 200);
  connect(server);
  subscribe();
  auto participant = support::test_participant("listener");
  ASSERT_TRUE(participant.ok());
  Latest<wire::vision_msgs::Detection3DArray> arrays;
  const auto subscriber = wire::Subscriber<wire::vision_msgs::Detection3DArray>::create(
      *participant, "tracks", {wire::qos::results()},
      [&](wire::vision_msgs::Detection3DArray&& message, const wire::SampleMeta&) {
        arrays.add(message);
      });
  ASSERT_TRUE(subscriber.ok());
  send_frames();
  ASSERT_TRUE(sets_.wait_for([](const TrackSet& s) { return has_one(s) && s.tracks[0].age_s > 1; }))
      << server.log();
  ASSERT_TRUE(arrays.wait_for([](const auto& array) { return !array.detections.empty(); }));
  stop_frames();
  std::int64_t last = 0;
  for (const TrackSet& set : sets_.items()) {
    EXPECT_GT(set.stamp_ns, last);
    last = set.stamp_ns;
    EXPECT_EQ(set.frame_id, "wall");
    EXPECT_FALSE(set.in_fixed_frame);
    for (const TrackedObject& object : set.tracks) {
      EXPECT_EQ(object.id, 1U);
      EXPECT_EQ(object.name, "stub_1");
      EXPECT_EQ(object.state, TrackedState::confirmed);
    }
  }
  for (const auto& array : arrays.items()) {
    EXPECT_EQ(array.header.frame_id, "wall");
    for (const auto& detection : array.detections) {
      EXPECT_EQ(detection.id, "1");
      EXPECT_EQ(detection.results.at(0).hypothesis.class_id, "stub");
      EXPECT_EQ(detection.results[0].pose.covariance[0], 1e-4);
      EXPECT_EQ(detection.header.stamp.nanosec, array.header.stamp.nanosec);
    }
  }
  expect_all_accounted_for();
  EXPECT_GT(details()["searches taken by tracking"], 0U);
  EXPECT_EQ(details()["searches of frames that were not followed"], 0U);
}

TEST_F(TracksOfFrames, AreNamedHeldAndForgotten) {
  support::StubServer server;
  connect(server);
  const Status none = client_->rename_track("stub_1", "mine");
  EXPECT_EQ(none.code, StatusCode::not_found) << none.message;
  subscribe();
  send_frames();
  ASSERT_TRUE(sets_.wait_for(has_one)) << server.log();
  EXPECT_EQ(client_->rename_track("1", "not a name").code, StatusCode::invalid_argument);
  ASSERT_TRUE(client_->rename_track("1", "mine").ok());
  ASSERT_TRUE(
      sets_.wait_for([](const TrackSet& s) { return has_one(s) && s.tracks[0].name == "mine"; }));
  ASSERT_TRUE(client_->hold_track("mine").ok());
  ASSERT_TRUE(sets_.wait_for([](const TrackSet& s) { return has_one(s) && s.tracks[0].held; }));
  ASSERT_TRUE(client_->hold_track("mine", false).ok());
  ASSERT_TRUE(client_->forget_track("mine").ok());
  const auto ended = sets_.wait_for([](const TrackSet& s) { return !s.ended.empty(); });
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->ended[0].id, 1U);
  EXPECT_EQ(ended->ended[0].name, "mine");
  // The next search finds the object again: it has another id.
  const auto again =
      sets_.wait_for([](const TrackSet& s) { return has_one(s) && s.tracks[0].id == 2; });
  ASSERT_TRUE(again);
  const Status gone = client_->hold_track("mine");
  EXPECT_EQ(gone.code, StatusCode::not_found);
  EXPECT_NE(gone.message.find("stub_2 (2)"), std::string::npos) << gone.message;
}

/// Lines of a log that hold a track with this id.
std::size_t lines_of_track(const std::string& log, const std::string& id) {
  const std::string text = support::read_text(log), word = "\"id\":" + id + ",";
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

bool eventually(const std::function<bool()>& happened) {
  for (int i = 0; i < 300; ++i) {
    if (happened()) return true;
    std::this_thread::sleep_for(milliseconds(50));
  }
  return false;
}

TEST_F(TracksOfFrames, GoOnForASubscriberThatIsKilledAndRestarted) {
  support::StubServer server;
  connect(server);
  const auto command = support::own_command("bpa-client", {"tracks", "--json"});
  const std::string folder = support::scratch_folder();
  send_frames();
  for (int run = 0; run < 3; ++run) {
    const std::string log = folder + "/tracks" + std::to_string(run);
    support::Process subscriber(command, log);
    ASSERT_TRUE(eventually([&] { return lines_of_track(log, "1") > 5; }))
        << run << support::read_text(log).size() << server.log();
    EXPECT_EQ(lines_of_track(log, "2"), 0U);
    subscriber.signal(SIGKILL);
    subscriber.wait(milliseconds(5000));
  }
  stop_frames();
  expect_all_accounted_for();
}

TEST_F(TracksOfFrames, AreInTheFixedFrameThatAnotherParticipantTells) {
  support::StubServer server({"tracking.fixed_frame=map", "tracking.tf_wait_ms=50"});
  connect(server);
  subscribe();
  send_frames();
  ASSERT_TRUE(
      eventually([&] { return details()["frames not followed: no transform of the camera"] > 0; }));
  EXPECT_TRUE(sets_.items().empty());
  EXPECT_NE(server.log().find("no transform of the camera"), std::string::npos) << server.log();

  auto participant = support::test_participant("robot");
  ASSERT_TRUE(participant.ok());
  using Message = wire::tf2_msgs::TFMessage;
  auto moving = wire::Publisher<Message>::create(*participant, "tf", {wire::qos::transforms()});
  auto fixed =
      wire::Publisher<Message>::create(*participant, "tf_static", {wire::qos::static_transforms()});
  ASSERT_TRUE(moving.ok() && fixed.ok());
  Message mount;  // the camera looks along the arm's x axis
  mount.transforms.resize(1);
  mount.transforms[0].header.frame_id = "arm";
  mount.transforms[0].child_frame_id = "wall";
  mount.transforms[0].transform.rotation = {-0.5, 0.5, -0.5, 0.5};
  ASSERT_TRUE(fixed->publish(mount).ok());  // latched
  // The arm moves by 1 m in a second of the frames' time.
  const auto arm_x = [](std::int64_t stamp_ns) { return 1e-9 * static_cast<double>(stamp_ns); };
  std::jthread robot([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      Message pose;
      pose.transforms.resize(1);
      const std::int64_t stamp = 1'000'000'000 + 20'000'000 * (sent_ + 2) + 7'000'000;
      pose.transforms[0].header = {wire::builtin_interfaces::from_ns(stamp), "map"};
      pose.transforms[0].child_frame_id = "arm";
      pose.transforms[0].transform.translation.x = arm_x(stamp);
      EXPECT_TRUE(moving->publish(pose).ok());
      std::this_thread::sleep_for(milliseconds(10));
    }
  });
  const auto set = sets_.wait_for(has_one);
  ASSERT_TRUE(set) << server.log();
  EXPECT_EQ(set->frame_id, "map");
  EXPECT_EQ(set->camera_frame_id, "wall");
  EXPECT_TRUE(set->in_fixed_frame);
  EXPECT_NEAR(set->frame_from_camera.position[0], arm_x(set->stamp_ns), 1e-6);
  EXPECT_NEAR(std::abs(set->frame_from_camera.orientation[0]), 0.5, 1e-9);
  // The wall is 0.8 m before the camera, which has moved since the search's frame.
  const double ahead = set->tracks[0].frame_from_object.position[0] - arm_x(set->stamp_ns);
  EXPECT_LT(ahead, 0.8);
  EXPECT_GT(ahead, -1);
  const double z = 0.001 * depth[support::kHeight / 2 * support::kWidth + support::kWidth / 2];
  const auto found = client_->detect_in(view(5));
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found->best().at(0).camera_from_object.position[2], z, 1e-6)
      << "in the camera's frame";
  EXPECT_EQ(client_->rename_track("1", "arm").code, StatusCode::invalid_argument);
  EXPECT_EQ(details()["frames of /tf"], 2U);
  robot.request_stop();
  stop_frames();
  expect_all_accounted_for();
}

TEST_F(TracksOfFrames, AreTransformsByTheirNamesWhereAskedFor) {
  support::StubServer server({"tracking.publish_tf=true", "tracking.fixed_frame=wall"});
  connect(server);
  auto participant = support::test_participant("listener");
  ASSERT_TRUE(participant.ok());
  Latest<std::string> frames;
  const auto subscriber = wire::Subscriber<wire::tf2_msgs::TFMessage>::create(
      *participant, "tf", {wire::qos::transforms()},
      [&](wire::tf2_msgs::TFMessage&& message, const wire::SampleMeta&) {
        for (const auto& t : message.transforms)
          frames.add(t.header.frame_id + ">" + t.child_frame_id);
      });
  ASSERT_TRUE(subscriber.ok());
  send_frames();
  EXPECT_TRUE(frames.wait_for([](const std::string& name) { return name == "wall>stub_1"; }))
      << server.log();
  // What the server itself publishes is not read back.
  EXPECT_EQ(details()["transforms taken"], 0U);
  stop_frames();
}

TEST_F(TracksOfFrames, CostNothingWithoutASubscriber) {
  support::StubServer server;
  connect(server);
  send_frames();
  ASSERT_TRUE(eventually([&] { return details()["frames not followed: no subscriber"] > 10; }));
  EXPECT_EQ(details()["frames followed"], 0U);
  stop_frames();
  expect_all_accounted_for();
}

}  // namespace
}  // namespace bpa
