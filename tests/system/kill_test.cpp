// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/kills.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process_reading.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// Parts that are killed at random moments, again and again: the server while a client streams, SDK
// clients while they call. cyclone/kill_peer_test.cpp and openni/kill_recorder_test.cpp have
// others.

namespace bpa {
namespace {

using std::chrono::milliseconds;

/// A request that goes out before the new server is known fails when the old one's lease of 5 s
/// ends.
constexpr milliseconds kOldClient{8000};
/// After this the server has forgotten all clients that are dead: their lease and a second.
constexpr milliseconds kForgotten{6000};

/// A new client gets an answer.
Status answers_new_client(milliseconds left) {
  ClientOptions options = support::client_options();
  options.timeout = left;
  auto client = Client::connect(options);
  return client.ok() ? client->models().status() : client.status();
}

TEST(Kill, ServerIsBackForNewAndOldClients) {
  const std::string folder = support::scratch_folder(), log = folder + "/killed.log";
  const auto model =
      modeling::model_source_from_mesh(test::box_mesh({0.06f, 0.04f, 0.025f}), "brick", 1);
  ASSERT_TRUE(model.ok()) << model.status().message;
  ASSERT_TRUE(io::save_model(folder + "/library", *model).ok());
  const auto start = [&] {
    return std::make_shared<support::Process>(
        support::own_command("bpa-server", {"--library", folder + "/library"}), log);
  };
  std::atomic<int> results{0};
  std::optional<Client> client;
  {
    const auto first = start();
    auto connected = Client::connect(support::client_options());
    ASSERT_TRUE(connected.ok()) << connected.status().message << support::read_text(log);
    client.emplace(std::move(connected).value());
  }
  const support::WallView wall;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet&) { ++results; }).ok());
  std::jthread stream([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      (void)client->publish_frame(wall.view());  // fails while there is no server
      std::this_thread::sleep_for(milliseconds(10));
    }
  });
  const auto check = [&] {
    const Status old = support::within(kOldClient, [&](milliseconds left) {
      return client->detect_in(wall.view(), {}, left).status();
    });
    EXPECT_TRUE(old.ok()) << old.message << support::read_text(log);
    const int before = results;
    const Status streamed = support::within(milliseconds(5000), [&](milliseconds) {
      return results > before ? Status() : Status(StatusCode::timeout, "no result of the stream");
    });
    EXPECT_TRUE(streamed.ok()) << streamed.message << support::read_text(log);
  };
  support::kill_again_and_again("server", {start, answers_new_client, check});
}

/// What a server holds, as its clients see it and as the system does.
struct Held {
  Held(Client& client, support::StubServer& server)
      : reading(support::read_process(server.process().pid())), status(client.status()) {}

  const support::Reading reading;
  const Result<ServerStatus> status;
};

TEST(Kill, ClientIsForgottenWithAllThatTheServerHeldForIt) {
  support::StubServer server({"queue.requests=4"}, 50);
  auto watcher = Client::connect(support::client_options());
  ASSERT_TRUE(watcher.ok()) << watcher.status().message << server.log();
  const auto caller = [](const std::string& calls) {
    return std::vector<std::string>{BPA_BINARY_DIR "/tests/bpa-frame-caller",
                                    std::to_string(support::test_domain()),
                                    support::test_namespace(),
                                    calls,
                                    "3000",
                                    "stream"};
  };
  const std::string log = support::scratch_folder() + "/caller.log";
  const auto works = [&](milliseconds left) {
    const int code = support::run(caller("1"), log, left);
    return code == 0 ? Status() : Status(StatusCode::timeout, support::read_text(log));
  };
  ASSERT_TRUE(works(milliseconds(10000)).ok()) << support::read_text(log) << server.log();
  std::this_thread::sleep_for(kForgotten);
  const Held before(*watcher, server);
  const auto start = [&] { return std::make_shared<support::Process>(caller("100000")); };
  support::kill_again_and_again("client", {start, works});
  std::this_thread::sleep_for(kForgotten);
  const Held after(*watcher, server);
  ASSERT_TRUE(before.status.ok() && after.status.ok()) << server.log();
  EXPECT_GT(after.status->requests_served, before.status->requests_served);
  EXPECT_GT(after.status->frames_received, 0U);
  EXPECT_EQ(after.status->queue_length, 0U);
  EXPECT_EQ(after.reading.descriptors, before.reading.descriptors);
  EXPECT_EQ(after.reading.threads, before.reading.threads);
  EXPECT_LT(after.reading.memory_mb, before.reading.memory_mb + 20);
}

}  // namespace
}  // namespace bpa
