// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <gtest/gtest.h>

#include "tests/support/cyclone.hpp"
#include "tests/support/kills.hpp"
#include "tests/support/process_reading.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// A robot on Eclipse Cyclone DDS that is killed while it publishes a camera's images, subscribes to
// results and asks, again and again.

namespace bpa {
namespace {

using std::chrono::milliseconds;

TEST(Kill, PeerHearsResultsOnceItIsStartedAnew) {
  support::keep_cyclone_on_this_machine();
  support::StubServer server({"input.color=camera/color", "input.depth=camera/depth",
                              "input.camera_info=camera/info", "queue.frames=5"});
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message << server.log();
  const std::string log = support::scratch_folder() + "/robot.log";
  const auto start = [&] {
    return std::make_shared<support::Process>(
        support::cyclone_command("cyclone_robot", {support::test_namespace(), "60"}), log);
  };
  const auto works = [&](milliseconds) {
    const bool hears = support::read_text(log).find("detections") != std::string::npos;
    return hears ? Status() : Status(StatusCode::timeout, "the robot hears no results");
  };
  const support::WallView wall;
  const auto check = [&] {
    const auto found = client->detect_in(wall.view());
    EXPECT_TRUE(found.ok()) << found.status().message << server.log();
  };
  {
    const auto first = start();
    ASSERT_TRUE(support::within(milliseconds(10000), works).ok()) << server.log();
  }
  const support::Reading before = support::read_process(server.process().pid());
  support::kill_again_and_again("peer", {start, works, check});
  const support::Reading after = support::read_process(server.process().pid());
  EXPECT_EQ(after.descriptors, before.descriptors);
  EXPECT_EQ(after.threads, before.threads);
  EXPECT_LT(after.memory_mb, before.memory_mb + 20);
}

}  // namespace
}  // namespace bpa
