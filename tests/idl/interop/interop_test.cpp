// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// With other processes on this machine: Eclipse Cyclone DDS and ourselves.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"
#include "tests/idl/wire/fill.hpp"
#include "tests/support/child_process.hpp"

namespace bpa::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Unload = bpa_msgs::UnloadModel;

const int kDomain = 1 + getpid() % 100;
const std::string kFolder = BPA_BINARY_DIR "/tests/";

bool has(const std::string& name) { return access((kFolder + name).c_str(), X_OK) == 0; }

/// Runs a peer of the tests folder; Cyclone looks for others on this machine only.
ChildProcess peer(const std::string& name, std::vector<std::string> arguments = {}) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>"
         "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>31"
         "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
         "</Domain></CycloneDDS>",
         1);
  arguments.insert(arguments.begin(), {kFolder + name, std::to_string(kDomain)});
  return ChildProcess(std::move(arguments));
}

constexpr std::size_t kLarge = 1'500'000;

/// Sends messages to an echo and expects each of them back, unchanged; frames with an image of
/// `color_bytes` if given.
template <class T>
void expect_echo(const Participant& participant, const std::string& name, int rounds,
                 std::size_t color_bytes = 0) {
  PublisherOptions publisher_options;
  auto publisher = Publisher<T>::create(participant, "/in/" + name, publisher_options);
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<T> back;
  SubscriberOptions subscriber_options;
  subscriber_options.qos = qos::reliable_input();
  auto subscriber = Subscriber<T>::create(participant, "/out/" + name, subscriber_options,
                                          [&](T&& message, const SampleMeta&) {
                                            const std::lock_guard<std::mutex> lock(mutex);
                                            back.push_back(std::move(message));
                                            changed.notify_all();
                                          });
  ASSERT_TRUE(publisher.ok() && subscriber.ok());
  ASSERT_TRUE(publisher->wait_for_matched(seconds(10))) << name;
  ASSERT_TRUE(subscriber->wait_for_matched(seconds(10))) << name;
  // What is sent while the other end is being matched may be lost; so first until one comes back.
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(publisher->publish(T{}).ok());
    std::unique_lock<std::mutex> lock(mutex);
    if (changed.wait_for(lock, milliseconds(100), [&] { return !back.empty(); })) break;
  }
  std::this_thread::sleep_for(milliseconds(300));
  {
    const std::lock_guard<std::mutex> lock(mutex);
    ASSERT_FALSE(back.empty()) << name;
    back.clear();
  }
  for (int round = 0; round < rounds; ++round) {
    T message = filled<T>(static_cast<unsigned>(round));
    if constexpr (std::is_same_v<T, bpa_msgs::RgbdFrame>) {
      if (color_bytes != 0) message.color.assign(color_bytes, static_cast<std::uint8_t>(round));
    }
    ASSERT_TRUE(publisher->publish(message).ok());
    std::unique_lock<std::mutex> lock(mutex);
    const auto wanted = static_cast<std::size_t>(round) + 1;
    ASSERT_TRUE(changed.wait_for(lock, seconds(5), [&] { return back.size() >= wanted; }))
        << name << " " << round;
    EXPECT_EQ(encode(back[wanted - 1]), encode(message)) << name << " " << round;
  }
  EXPECT_EQ(subscriber->statistics().malformed, 0U);
}

TEST(Interop, CycloneUnderstandsOurMessagesAndWeItsOwn) {
  if (!has("cyclone_echo")) GTEST_SKIP() << "built without Eclipse Cyclone DDS";
  ChildProcess echo = peer("cyclone_echo");
  ASSERT_TRUE(echo.started());
  auto participant = test_participant("interop");
  ASSERT_TRUE(participant.ok());
  expect_echo<sensor_msgs::Image>(*participant, "image", 5);
  expect_echo<sensor_msgs::PointCloud2>(*participant, "cloud", 5);
  expect_echo<bpa_msgs::RgbdFrame>(*participant, "frame", 5);
  expect_echo<bpa_msgs::SceneInterpretations>(*participant, "interpretations", 20);
  expect_echo<vision_msgs::Detection3DArray>(*participant, "detections", 5);
  expect_echo<visualization_msgs::MarkerArray>(*participant, "markers", 5);
  expect_echo<rcl_interfaces::ParameterEvent>(*participant, "events", 5);
  EXPECT_EQ(echo.finish(seconds(5)), 0);
}

TEST(Interop, APeerOfXcdr2AloneIsNamed) {
  if (!has("cyclone_echo")) GTEST_SKIP() << "built without Eclipse Cyclone DDS";
  std::mutex mutex;
  std::condition_variable changed;
  std::string said;
  auto participant = test_participant("interop", [&](LogLevel level, std::string_view text) {
    if (level < LogLevel::warning) return;
    const std::lock_guard<std::mutex> lock(mutex);
    said += std::string(text) + "\n";
    changed.notify_all();
  });
  ASSERT_TRUE(participant.ok());
  const auto publisher = Publisher<sensor_msgs::Image>::create(*participant, "/in/image", {});
  const auto subscriber = Subscriber<sensor_msgs::Image>::create(
      *participant, "/out/image", {}, [](sensor_msgs::Image&&, const SampleMeta&) {});
  ASSERT_TRUE(publisher.ok() && subscriber.ok());
  ChildProcess echo = peer("cyclone_echo", {"xcdr2"});
  std::unique_lock<std::mutex> lock(mutex);
  const auto has_said = [&](const char* words) { return said.find(words) != std::string::npos; };
  EXPECT_TRUE(changed.wait_for(lock, seconds(10), [&] {
    return has_said("rt/in/image: a peer's subscriber takes XCDR2 alone") &&
           has_said("rt/out/image: a peer's publisher offers XCDR2 alone");
  })) << said;
}

TEST(Interop, LargeFrameToCycloneAndBack) {
  if (!has("cyclone_echo")) GTEST_SKIP() << "built without Eclipse Cyclone DDS";
  ChildProcess echo = peer("cyclone_echo");
  auto participant = test_participant("interop");
  ASSERT_TRUE(participant.ok());
  expect_echo<bpa_msgs::RgbdFrame>(*participant, "frame", 5, kLarge);
}

TEST(Interop, CycloneClientsFirstCallIsAnswered) {
  if (!has("cyclone_caller")) GTEST_SKIP() << "built without Eclipse Cyclone DDS";
  auto participant = test_participant("interop");
  ASSERT_TRUE(participant.ok());
  std::atomic<int> calls = 0;
  auto server = ServiceServer<Unload>::create(
      *participant, "/interop/unload_model",
      [&calls](Unload::Request&& request, const ReplyToken<Unload>& token) {
        Unload::Response response;
        response.success = true;
        response.status.message = request.name;
        response.database_version = std::stoi(request.name.substr(6));
        ++calls;
        EXPECT_TRUE(token.reply(response).ok());
      });
  ASSERT_TRUE(server.ok());
  for (int client = 0; client < 3; ++client) {
    ChildProcess caller = peer("cyclone_caller", {"3"});
    EXPECT_EQ(caller.finish(seconds(20)), 0) << client;
  }
  EXPECT_EQ(calls, 9);
  EXPECT_EQ(server->statistics().malformed, 0U);
}

TEST(Interop, OwnPeerAndItsService) {
  ChildProcess echo = peer("wire_peer");
  auto participant = test_participant("interop");
  ASSERT_TRUE(participant.ok());
  expect_echo<bpa_msgs::RgbdFrame>(*participant, "frame", 20, kLarge);
  auto client = ServiceClient<Unload>::create(*participant, "/own/unload_model");
  ASSERT_TRUE(client.ok());
  for (int i = 0; i < 20; ++i) {
    Unload::Request request;
    request.name = std::to_string(i);
    const auto response = client->call(request, seconds(5));
    ASSERT_TRUE(response.ok()) << response.status().message;
    EXPECT_EQ(response.value().status.message, request.name);
  }
  EXPECT_EQ(echo.finish(seconds(5)), 0);
}

TEST(Interop, ServerThatCrashesAndComesBack) {
  auto participant = test_participant("interop");
  ASSERT_TRUE(participant.ok());
  auto client = ServiceClient<Unload>::create(*participant, "/own/unload_model");
  ASSERT_TRUE(client.ok());
  for (int life = 0; life < 2; ++life) {
    ChildProcess server = peer("wire_peer");
    bool answered = false;
    for (int i = 0; i < 20 && !answered; ++i) answered = client->call({}, milliseconds(500)).ok();
    EXPECT_TRUE(answered) << life;
    server.crash();
  }
}

}  // namespace
}  // namespace bpa::wire
