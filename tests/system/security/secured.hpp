// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "server/security/keystore.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// A server with a keystore, and its good clients.

namespace bpa::test {

/// Longer than any discovery and handshake takes here: the good ones are done in 1 s.
inline constexpr std::chrono::seconds kPatience{5};

/// queue.frames and queue.requests of the defaults.
inline constexpr int kQueueCapacity = 9;

/// With the names that the stub server and Cyclone's robot use.
inline server::ServerOptions names() {
  server::ServerOptions options;
  options.node.ros_namespace = support::test_namespace();
  options.input.color = "camera/color";
  options.input.depth = "camera/depth";
  options.input.camera_info = "camera/info";
  options.input.tf = options.output.tf = "tf";
  options.input.tf_static = "tf_static";
  options.output.diagnostics = "diagnostics";
  options.output.rosout = "rosout";
  options.node.remaps = {"/parameter_events:=parameter_events"};
  return options;
}

inline std::string make_keystore(const std::string& name, int domain = support::test_domain()) {
  const std::string folder = support::scratch_folder() + "/" + name;
  if (!std::filesystem::exists(folder)) {
    server::make_keystore(folder, server::default_permissions(names()), domain);
  }
  return folder;
}

inline std::string ours() { return make_keystore("ours"); }

inline std::vector<std::string> settings_with(const std::string& keystore) {
  return {"input.color=camera/color", "input.depth=camera/depth", "input.camera_info=camera/info",
          "security.keystore='" + keystore + "'"};
}

inline Result<Client> connect(const std::string& keystore, const std::string& enclave) {
  ClientOptions options = support::client_options();
  options.keystore = keystore;
  options.enclave = enclave;
  return Client::connect(options);
}

inline bool becomes_true(const std::function<bool()>& condition,
                         std::chrono::milliseconds patience = kPatience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return condition();
}

/// The server, and a robot that it knows.
class Secured : public testing::Test {
 protected:
  Secured() : server_(settings_with(ours())) {
    auto made = connect(ours(), "/robot");
    EXPECT_TRUE(made.ok()) << made.status().message << server_.log();
    if (made.ok()) robot_.emplace(std::move(made).value());
  }
  void SetUp() override { ASSERT_TRUE(robot_); }

  Client& robot() { return *robot_; }
  std::string log() const { return server_.log(); }

  /// The server publishes a result of it.
  void robot_sends(std::int64_t stamp_ns = 2'000) {
    EXPECT_TRUE(robot().publish_frame(support::WallView().view(stamp_ns)).ok()) << log();
  }

  /// What the robot alone has done is what the server counts, and it goes on serving.
  void expect_unchanged(std::uint64_t frames, std::uint64_t requests) {
    const auto status = robot().status();
    ASSERT_TRUE(status.ok()) << status.status().message << log();
    EXPECT_EQ(status->frames_received, frames) << log();
    EXPECT_EQ(status->requests_served, requests) << log();
    EXPECT_EQ(status->queue_capacity, kQueueCapacity) << log();
  }

 private:
  support::StubServer server_;
  std::optional<Client> robot_;
};

}  // namespace bpa::test
