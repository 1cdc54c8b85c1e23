// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

// bpa-client record --to and play as processes, with the stub server.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::vector<std::string> bpa_client(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"--timeout", "10"});
  return support::own_command("bpa-client", arguments);
}

nlohmann::json json_of(const std::string& path) {
  return nlohmann::json::parse(std::ifstream(path), nullptr, false);
}

/// Waits until a process has said something.
bool says(const std::string& log, const std::string& words) {
  const auto end = std::chrono::steady_clock::now() + seconds(15);
  while (std::chrono::steady_clock::now() < end) {
    if (support::read_text(log).find(words) != std::string::npos) return true;
    std::this_thread::sleep_for(milliseconds(20));
  }
  return false;
}

TEST(RecordAndPlay, FramesAndResultsComeBackWithTheirTimes) {
  const std::string folder = support::scratch_folder() + "/recording";
  const std::string log = support::scratch_folder() + "/record.log";
  const std::string play_log = support::scratch_folder() + "/play.log";
  support::StubServer server({"queue.frames=20"});
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  support::Process recorder(bpa_client({"record", "--to", folder}), log);
  ASSERT_TRUE(says(log, "recording to")) << support::read_text(log);

  const auto depth = support::wall_depth_mm();
  const auto rgb = support::wall_rgb();
  FrameView frame;
  frame.width = static_cast<int>(support::kWidth);
  frame.height = static_cast<int>(support::kHeight);
  frame.rgb = rgb.data();
  frame.depth_mm = depth.data();
  frame.fx = frame.fy = 60;
  frame.cx = 31.5;
  frame.cy = 23.5;
  frame.frame_id = "wall";
  // The recorder may need a moment until it hears us; what it has is what must come back.
  constexpr std::int64_t kSecond = 1'000'000'000, kMillisecond = 1'000'000;
  const std::filesystem::path first = folder + "/test/000001/depth/000000.png";
  for (int i = 1; i < 200 && !std::filesystem::exists(first); ++i) {
    frame.stamp_ns = i * kMillisecond;
    ASSERT_TRUE(client->publish_frame(frame).ok());
    std::this_thread::sleep_for(milliseconds(60));
  }
  std::this_thread::sleep_for(milliseconds(500));  // until it hears the server as well
  for (int i = 1; i <= 15; ++i) {
    frame.stamp_ns = i * kSecond;
    ASSERT_TRUE(client->publish_frame(frame).ok());
    std::this_thread::sleep_for(milliseconds(i % 5 == 0 ? 300 : 60));
  }
  std::this_thread::sleep_for(milliseconds(500));
  recorder.signal(SIGINT);
  ASSERT_EQ(recorder.wait(seconds(10)), 0) << support::read_text(log);

  const auto recording = json_of(folder + "/recording.json").at("frames");
  ASSERT_GE(recording.size(), 8U) << support::read_text(log);
  EXPECT_EQ(recording.back().at("stamp_ns"), 15 * kSecond);
  EXPECT_EQ(recording.back().at("frame_id"), "wall");
  const double length_s = recording.back().at("after_s");
  EXPECT_GT(length_s, 0.7);
  EXPECT_GE(json_of(folder + "/results.json").at("frames").size(), 15U);

  // Played, the server finds the same in every frame, in the same order, and it takes as long.
  const std::string json = support::scratch_folder() + "/played.json";
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_EQ(support::run(bpa_client({"play", folder, "--json", json}), play_log), 0)
      << support::read_text(play_log);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  EXPECT_GE(took.count(), length_s);
  const auto played = json_of(json).at("frames");
  ASSERT_EQ(played.size(), recording.size()) << support::read_text(play_log) << server.log();
  for (std::size_t i = 0; i < played.size(); ++i) {
    const auto& best = played[i].at("interpretations").at(0).at("placements").at(0);
    EXPECT_EQ(played[i].at("stamp_ns"), recording[i].at("stamp_ns"));
    EXPECT_NEAR(best.at("pose").at("translation_m").at(2).get<double>(), 0.788, 1e-6);
  }
  // Again into the same folder: refused, nothing is overwritten.
  EXPECT_EQ(support::run(bpa_client({"record", "--to", folder}), log), 1);
  EXPECT_NE(support::read_text(log).find("is there already"), std::string::npos);
}

}  // namespace
}  // namespace bpa
