// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/notify_socket.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// A server that is killed while a client streams, and started anew, again and again.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr int kKills = 6;
/// A request that goes out before the new server is known fails when the old one's lease of 5 s
/// ends.
constexpr milliseconds kOldClient{8000};

class KilledServer : public testing::Test {
 protected:
  KilledServer() : ready_(socket_name()) { setenv("NOTIFY_SOCKET", socket_name().c_str(), 1); }
  ~KilledServer() override { unsetenv("NOTIFY_SOCKET"); }

  void SetUp() override {
    auto model = model_source_from_mesh(test::box_mesh({0.06f, 0.04f, 0.025f}), "brick", 1);
    ASSERT_TRUE(model.ok()) << model.status().message;
    ASSERT_TRUE(io::save_model(folder_ + "/library", *model).ok());
  }
  /// Returns once the server says that it is ready.
  void start() {
    server_ = std::make_unique<support::Process>(
        support::own_command("bpa-server", {"--library", folder_ + "/library"}),
        folder_ + "/killed.log");
    std::string said = "?";  // or what the one that was killed said before
    while (!said.empty() && said.rfind("READY=1\nSTATUS=serving", 0) != 0) said = ready_.receive();
    ASSERT_FALSE(said.empty()) << log();
  }
  void kill() {
    server_->signal(SIGKILL);
    ASSERT_EQ(server_->wait(milliseconds(5000)), 128 + SIGKILL) << log();
  }
  std::string log() const { return support::read_text(folder_ + "/killed.log"); }

 private:
  static std::string socket_name() { return "@bpa_kill_test_" + std::to_string(getpid()); }

  const support::NotifySocket ready_;
  const std::string folder_ = support::scratch_folder();
  std::unique_ptr<support::Process> server_;
};

/// Asks until it succeeds; what the last one said when none did in time.
Status within(milliseconds time, const std::function<Status(milliseconds left)>& ask) {
  const auto end = Clock::now() + time;
  Status status;
  do {
    const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
    status = ask(std::max(left, milliseconds(1)));
    if (status.ok()) return status;
    std::this_thread::sleep_for(milliseconds(10));
  } while (Clock::now() < end);
  return status;
}

TEST_F(KilledServer, AnswersNewAndOldClientsOnceItIsStartedAnew) {
  start();
  const support::WallView wall;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message << log();
  std::atomic<int> results{0};
  ASSERT_TRUE(client->subscribe([&](const DetectionSet&) { ++results; }).ok());
  std::atomic<bool> stop{false};
  std::thread stream([&] {
    while (!stop) {
      (void)client->publish_frame(wall.view());  // fails while there is no server
      std::this_thread::sleep_for(milliseconds(10));
    }
  });
  std::minstd_rand random(20);
  for (int i = 0; i < kKills && !HasFailure(); ++i) {
    std::this_thread::sleep_for(milliseconds(random() % 500));
    kill();
    start();
    ClientOptions options = support::client_options();
    options.timeout = milliseconds(2000);
    auto fresh = Client::connect(options);
    EXPECT_TRUE(fresh.ok()) << "kill " << i << ": " << fresh.status().message << log();
    EXPECT_TRUE(fresh.ok() && fresh->models().ok()) << "kill " << i << log();
    const Status old = within(kOldClient, [&](milliseconds left) {
      return client->detect_in(wall.view(), {}, left).status();
    });
    EXPECT_TRUE(old.ok()) << "kill " << i << ": " << old.message << log();
    const int before = results;
    const Status streamed = within(milliseconds(5000), [&](milliseconds) {
      return results > before ? Status() : Status(StatusCode::timeout, "no result of the stream");
    });
    EXPECT_TRUE(streamed.ok()) << "kill " << i << ": " << streamed.message << log();
  }
  stop = true;
  stream.join();
}

}  // namespace
}  // namespace bpa
