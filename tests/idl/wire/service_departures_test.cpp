// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"
#include "tests/support/temporary_folder.hpp"

// Calls whose server leaves, or does not answer any more, before or while they wait.

namespace bpa::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Unload = bpa_msgs::UnloadModel;
using UnloadServer = ServiceServer<Unload>;
using UnloadClient = ServiceClient<Unload>;

/// Keeps what it is asked; the server of a process that was killed does the same to its clients.
class SilentServer {
 public:
  SilentServer(const Participant& participant, const std::string& service)
      : server_(UnloadServer::create(participant, service,
                                     [this](Unload::Request&&, const ReplyToken<Unload>& token) {
                                       const std::lock_guard<std::mutex> lock(mutex_);
                                       tokens_.push_back(token);
                                     })) {}

  bool is_asked() {
    for (int i = 0; i < 1000; ++i) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!tokens_.empty()) return true;
      }
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }
  Status answer() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return tokens_.at(0).reply({});
  }
  void leave() { server_ = Status(StatusCode::not_found, "left"); }

 private:
  std::mutex mutex_;
  std::vector<ReplyToken<Unload>> tokens_;
  Result<UnloadServer> server_;
};

/// A participant to which others of this process send as other processes do, over UDP. That stays
/// with the process.
Result<Participant> distant_participant(const std::string& name) {
  const test::TemporaryFolder folder;
  const std::string profiles = folder / "profiles.xml";
  test::spill(
      profiles,
      "<dds xmlns=\"http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles\"><library_settings>"
      "<intraprocess_delivery>OFF</intraprocess_delivery></library_settings></dds>");
  ParticipantOptions options;
  options.node.name = name;
  options.discovery = test_discovery();
  options.profiles = profiles;
  return Participant::create(std::move(options));
}

class Departures : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(one.ok() && two.ok() && three.ok());
    ASSERT_TRUE(client.ok()) << client.status().message;
  }
  std::future<Result<Unload::Response>> call() {
    return std::async(std::launch::async, [&] { return client->call({}, seconds(10)); });
  }

  const Result<Participant> one = distant_participant("one");
  const Result<Participant> two = distant_participant("two");
  const Result<Participant> three = distant_participant("three");
  const Result<UnloadClient> client = UnloadClient::create(*three, "leaves");
};

// Discovery tells the client that its server leaves while the thread that takes samples is busy.
TEST_F(Departures, AnAnswerArrivesThoughItsServerLeavesAtOnce) {
  using Message = sensor_msgs::CameraInfo;
  std::promise<void> busy;
  const auto subscriber =
      Subscriber<Message>::create(*three, "busy", {qos::results()}, [&](Message&&, auto&) {
        busy.set_value();
        std::this_thread::sleep_for(milliseconds(200));
      });
  auto publisher = Publisher<Message>::create(*one, "busy", {qos::results()});
  ASSERT_TRUE(subscriber.ok() && publisher.ok());
  ASSERT_TRUE(publisher->wait_for_matched(seconds(10)));
  SilentServer server(*one, "leaves");
  auto answered = call();
  ASSERT_TRUE(server.is_asked());
  ASSERT_TRUE(publisher->publish(Message()).ok());
  ASSERT_EQ(busy.get_future().wait_for(seconds(10)), std::future_status::ready);
  EXPECT_TRUE(server.answer().ok());
  server.leave();
  const Status status = answered.get().status();
  EXPECT_TRUE(status.ok()) << status.message;
}

}  // namespace
}  // namespace bpa::wire
