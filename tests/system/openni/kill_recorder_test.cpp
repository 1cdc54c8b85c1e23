// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "camera/oni_file.hpp"
#include "tests/support/kills.hpp"
#include "tests/system/openni/sim_sensor.hpp"

// A server that is killed while it records its sensor, again and again.

namespace bpa {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class KilledRecorder : public testing::Test {
 protected:
  void SetUp() override {
    support::write_scenes(folder_.path(), {support::plate_frame({{0, 0, 0.7, 0.08, {200, 0, 0}}},
                                                                support::kSimCamera, 0)});
    support::set_sensor(folder_.path());
  }
  std::shared_ptr<support::Process> start() {
    const auto server = std::make_shared<support::SensorServer>(folder_.path(), "openni2",
                                                                std::vector<std::string>{});
    return {server, &server->process()};
  }
  /// Begins a recording in a file that has not been there.
  Status record(milliseconds left) {
    ClientOptions options = support::client_options();
    options.timeout = left;
    auto client = Client::connect(options);
    if (!client.ok()) return client.status();
    const Status status = client->start_recording(path_of(recordings_ + 1)).status();
    const bool records = status.ok() || status.code == StatusCode::busy;  // busy: with one that
    recordings_ += records ? 1 : 0;                                       // we did not hear of
    return records ? Status() : status;
  }
  /// Records for a moment and completes the file.
  void complete(const std::string& path) const {
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message;
    const auto begun = client->start_recording(path);
    ASSERT_TRUE(begun.ok()) << begun.status().message;
    std::this_thread::sleep_for(milliseconds(300));
    const auto done = client->stop_recording();
    ASSERT_TRUE(done.ok()) << done.status().message;
    const auto info = camera::inspect_oni_file(path);
    ASSERT_TRUE(info.ok()) << info.status().message;
    ASSERT_FALSE(info->streams.empty());
    EXPECT_GT(info->streams[0].frames, 0U);
  }
  /// The recordings that were cut off: they lie beside and are readable or refused.
  int halves() const {
    int count = 0;
    for (int i = 1; i <= recordings_; ++i) {
      EXPECT_FALSE(fs::exists(path_of(i))) << i;
      const std::string half = path_of(i) + ".part";
      if (!fs::exists(half)) continue;
      ++count;
      const auto info = camera::inspect_oni_file(half);
      EXPECT_TRUE(info.ok() || info.status().message.find(half) != std::string::npos) << half;
    }
    return count;
  }
  std::string path_of(int number) const { return folder_ / (std::to_string(number) + ".oni"); }

  const test::TemporaryFolder folder_;
  int recordings_ = 0;
};

TEST_F(KilledRecorder, RecordsAgainAndLosesNothingThatWasComplete) {
  const std::string first = folder_ / "complete.oni";
  {
    const auto server = start();
    complete(first);
  }
  const std::string bytes = test::slurp(first);
  const auto check = [&] {
    EXPECT_TRUE(test::slurp(first) == bytes);
    EXPECT_EQ(halves(), recordings_);  // the last is being written
  };
  support::kill_again_and_again(
      "recorder",
      {[&] { return start(); }, [&](milliseconds left) { return record(left); }, check});
  const auto server = start();
  complete(path_of(1));  // of which there is a half
  complete(folder_ / "another.oni");
}

}  // namespace
}  // namespace bpa
