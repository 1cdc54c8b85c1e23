// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <map>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/support/cyclone.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_view.hpp"

// A robot on Eclipse Cyclone DDS that has our .idl and nothing else of us, and our server.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// The lines of the robot's output, split into words.
std::vector<std::vector<std::string>> lines_of(const std::string& text, const std::string& first) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream stream(text.substr(0, text.rfind('\n') + 1));
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::vector<std::string> split;
    for (std::string word; words >> word;) split.push_back(word);
    if (!split.empty() && split[0] == first) lines.push_back(std::move(split));
  }
  return lines;
}

std::int64_t now_ms() {
  return std::chrono::duration_cast<milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

class OtherVendor : public testing::Test {
 protected:
  OtherVendor()
      : server({"input.color=camera/color", "input.depth=camera/depth",
                "input.camera_info=camera/info", "queue.frames=5"}) {
    support::keep_cyclone_on_this_machine();
    robot_log = support::scratch_folder() + "/robot.log";
    robot = std::make_unique<support::Process>(
        support::cyclone_command("cyclone_robot", {support::test_namespace(), "60"}), robot_log);
  }
  std::string said() const { return support::read_text(robot_log); }
  /// The first detections that came after a time, when they did; -1: none within 20 s.
  std::int64_t next_detections_ms(std::int64_t after_ms) const {
    const std::int64_t end = now_ms() + 20'000;
    while (now_ms() < end) {
      for (const auto& line : lines_of(said(), "detections")) {
        if (std::stoll(line[1]) > after_ms) return std::stoll(line[1]);
      }
      std::this_thread::sleep_for(milliseconds(20));
    }
    return -1;
  }

  support::StubServer server;
  std::string robot_log;
  std::unique_ptr<support::Process> robot;
};

TEST_F(OtherVendor, CameraInDetectionsOutAndRequestsAnswered) {
  ASSERT_NE(next_detections_ms(0), -1) << said() << server.log();
  const auto end = std::chrono::steady_clock::now() + seconds(20);
  while (lines_of(said(), "answered").size() < 3 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(50));
  }
  const std::string text = said();
  const auto detections = lines_of(text, "detections");
  ASSERT_GE(detections.size(), 10U) << text;
  for (const auto& line : detections) {
    EXPECT_EQ(line[3], "robot_camera");
    EXPECT_EQ(line[4], "stub");
    EXPECT_EQ(line[5], "0.8750");
  }
  // Interpretations of the same frames, each with the depth that the camera saw.
  std::map<std::string, std::string> depth_of;
  for (const auto& line : lines_of(text, "interpretations")) depth_of[line[2]] = line[4];
  for (const auto& [stamp, depth] : depth_of) EXPECT_EQ(depth, "0.9000") << stamp;
  int common = 0;
  for (const auto& line : detections) common += depth_of.count(line[2]) == 1 ? 1 : 0;
  EXPECT_GE(common, static_cast<int>(detections.size()) - 2);
  const auto answered = lines_of(text, "answered");
  ASSERT_GE(answered.size(), 3U) << text << server.log();
  for (const auto& line : answered) {
    EXPECT_EQ(line[2], "1");
    EXPECT_EQ(line[3], "1");
  }
}

/// The server is killed without a word and started again: the robot and an SDK client go on.
TEST_F(OtherVendor, AServerThatIsKilledAndComesBack) {
  ASSERT_NE(next_detections_ms(0), -1) << said() << server.log();
  std::atomic<std::int64_t> last_result_ms{0};
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet&) { last_result_ms = now_ms(); }).ok());
  server.process().signal(SIGKILL);
  ASSERT_EQ(server.process().wait(seconds(5)), 128 + SIGKILL);
  const std::int64_t killed_ms = now_ms();
  server.start();
  const std::int64_t started_ms = now_ms();

  const std::int64_t robot_ms = next_detections_ms(killed_ms);
  ASSERT_NE(robot_ms, -1) << said() << server.log();
  while (last_result_ms <= killed_ms && now_ms() < started_ms + 20'000) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  ASSERT_GT(last_result_ms, killed_ms) << server.log();
  const std::int64_t client_ms = last_result_ms;
  auto found = client->detect();
  ASSERT_TRUE(found.ok()) << found.status().message;
  const std::int64_t call_ms = now_ms();
  const std::size_t before = lines_of(said(), "answered").size();
  while (lines_of(said(), "answered").size() < before + 2 && now_ms() < started_ms + 30'000) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  EXPECT_GE(lines_of(said(), "answered").size(), before + 2) << said();
  RecordProperty("cyclone_peer_ms", static_cast<int>(robot_ms - started_ms));
  std::cout << "after the start of the new server: Cyclone peer has detections after "
            << robot_ms - started_ms << " ms, SDK subscription after " << client_ms - started_ms
            << " ms, SDK call answered after " << call_ms - started_ms << " ms\n";
}

/// A killed peer would leave its locks in shared memory locked, and processes of different releases
/// of Fast DDS abort when they share it.
TEST_F(OtherVendor, NoMemoryIsShared) {
  ASSERT_NE(next_detections_ms(0), -1) << said() << server.log();
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok());
  ASSERT_TRUE(client->detect().ok());
  ASSERT_TRUE(client->publish_frame(support::WallView().view()).ok());
  for (const pid_t process : {server.process().pid(), getpid()}) {
    const std::string maps = support::read_text("/proc/" + std::to_string(process) + "/maps");
    ASSERT_NE(maps.find("libfast"), std::string::npos) << "maps cannot be read";
    EXPECT_EQ(maps.find("/dev/shm/"), std::string::npos) << maps;
  }
}

}  // namespace
}  // namespace bpa
