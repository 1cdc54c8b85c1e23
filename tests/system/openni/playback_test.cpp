// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Recordings and data sets as cameras: all frames, some, again and again, and damaged files.
#include <gtest/gtest.h>

#include "tests/system/openni/sim_sensor.hpp"

namespace bpa {
namespace {

using support::SensorServer;
using support::set_sensor;

class Playback : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<support::Plate> plates = {{0, 0, 0.7, 0.08, {200, 200, 0}},
                                                {0.2, 0.1, 1.0, 0.15, {240, 240, 240}}};
    support::write_scenes(folder.path(), {support::plate_frame(plates, support::kSimCamera, 0)});
    set_sensor(folder.path());
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  /// The server answers a service.
  void expect_serving() {
    const auto client = Client::connect(support::client_options());
    EXPECT_TRUE(client.ok()) << client.status().message;
  }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
};

TEST_F(Playback, PlaybackRepeatsStartsWhereItIsToldAndShowsEveryFrame) {
  const std::string file = folder / "short.oni";
  int frames = 0;
  {
    support::SensorServer server(folder.path(), "openni2", {});
    ASSERT_TRUE(server.wait_for("images come from")) << server.log();
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message;
    ASSERT_TRUE(client->start_recording(file, 0.6).ok());
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    const auto recording = client->stop_recording();  // it ended by itself
    ASSERT_TRUE(recording.ok()) << recording.status().message;
    frames = recording->frames;
    ASSERT_GT(frames, 10);
  }
  const auto shown = [&](const std::vector<std::string>& settings, std::size_t enough) {
    support::SensorServer server("", file, settings);
    const bool plays = server.wait_for("images come from the recording");
    EXPECT_TRUE(plays) << server.log();
    auto client = Client::connect(support::client_options());
    if (!plays || !client.ok()) return std::size_t{0};
    std::size_t sets = 0;
    for (int i = 0; i < 400 && sets < enough && server.said("come to its end") == 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const auto status = client->status();
      if (!status.ok()) break;
      for (const auto& [key, value] : status->details) {
        if (key == "capture: sets of images") sets = std::stoul(value);
      }
    }
    const auto status = client->status();  // once more after the end
    for (const auto& [key, value] : status->details) {
      if (key == "capture: sets of images") sets = std::stoul(value);
    }
    return sets;
  };
  const auto count = static_cast<std::size_t>(frames);
  constexpr std::size_t kAll = 1000;
  EXPECT_EQ(shown({"capture.every_frame=true"}, kAll), count);
  EXPECT_EQ(shown({"capture.every_frame=true", "capture.start_frame=8"}, kAll), count - 7);
  EXPECT_GT(shown({"capture.loop=true", "capture.speed=4"}, 3 * count), 2 * count);
  support::SensorServer beyond("", file, {"capture.start_frame=9000"});
  EXPECT_TRUE(beyond.wait_for("capture.start_frame is 9000; ")) << beyond.log();
}

TEST_F(Playback, ADataSetIsACameraToo) {
  support::SensorServer server("", "bop:" + folder.path(), {"capture.loop=true"});
  support::CameraListener camera(*participant);
  support::Listener<wire::sensor_msgs::PointCloud2> points(*participant, "points",
                                                           wire::qos::reliable_input());
  ASSERT_TRUE(camera.depth.wait_for(6) && camera.color.wait_for(6) && points.wait_for(1))
      << server.log();
  EXPECT_EQ(camera.depth.messages().front().encoding, "32FC1");
  const auto cloud = points.messages().front();
  EXPECT_EQ(cloud.width, 320U);
  EXPECT_EQ(cloud.height, 240U);
  EXPECT_EQ(cloud.header.frame_id, "camera_color_optical_frame");
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(Playback, ExposureGainAndWhiteBalanceAreSettings) {
  const auto mean_color = [&](const std::vector<std::string>& settings) {
    support::SensorServer server(folder.path(), "openni2", settings);
    support::CameraListener camera(*participant);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    EXPECT_TRUE(camera.color.wait_for(2)) << server.log();
    if (camera.color.messages().empty()) return sum;
    const wire::sensor_msgs::Image image = camera.color.messages().back();
    for (std::size_t i = 0; i < image.data.size(); ++i) {
      sum[static_cast<Eigen::Index>(i % 3)] += image.data[i];
    }
    EXPECT_EQ(server.said("does not let set"), 0) << server.log();
    return Eigen::Vector3d(sum * 3 / static_cast<double>(image.data.size()));
  };
  const Eigen::Vector3d usual = mean_color({});
  ASSERT_GT(usual.minCoeff(), 20);
  // What the device does with them is in openni2_sim/sim_device.cpp; values are cut to whole ones.
  const auto expect_parts = [&](const Eigen::Vector3d& color, const Eigen::Vector3d& parts) {
    const Eigen::Vector3d is = color.cwiseQuotient(usual);
    EXPECT_LT((is - parts).cwiseAbs().maxCoeff(), 0.02) << is.transpose();
  };
  expect_parts(mean_color({"capture.auto_exposure=false", "capture.exposure=50"}), {0.5, 0.5, 0.5});
  expect_parts(
      mean_color({"capture.auto_exposure=false", "capture.exposure=50", "capture.gain=150"}),
      {0.75, 0.75, 0.75});
  expect_parts(mean_color({"capture.auto_white_balance=false"}), {1, 1, 0.7});
}

TEST_F(Playback, DamagedRecordings) {
  set_sensor(folder.path());
  const std::string good = folder / "good.oni";
  {
    SensorServer server(folder.path(), "openni2", {});
    ASSERT_TRUE(server.wait_for("images come from")) << server.log();
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message;
    for (const char* path : {"/tmp/elsewhere.oni", "../x.oni", "a/../../x.oni", "x.txt", ""}) {
      EXPECT_EQ(client->start_recording(path).status().code, StatusCode::invalid_argument) << path;
    }
    ASSERT_TRUE(client->start_recording("good.oni", 30).ok());
    EXPECT_EQ(client->start_recording(folder / "b.oni", 30).status().code, StatusCode::busy);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    const auto recording = client->stop_recording();
    ASSERT_TRUE(recording.ok()) << recording.status().message;
    EXPECT_GT(recording->frames, 5);
    EXPECT_EQ(recording->bytes, std::filesystem::file_size(good));
  }
  const std::string bytes = test::slurp(good);
  test::spill(folder / "truncated.oni", bytes.substr(0, bytes.size() / 2));
  std::string corrupt = bytes;
  corrupt[24] = 'X';  // the first record
  test::spill(folder / "corrupt.oni", corrupt);
  for (const auto& [file, complaint] :
       {std::pair("truncated.oni", "is truncated: it ends at byte"),
        std::pair("corrupt.oni", "is damaged: the record at byte 24"),
        std::pair("none.oni", "there is no such file")}) {
    SensorServer server("", folder / file, {});
    ASSERT_TRUE(server.wait_for(complaint)) << server.log();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(server.said(complaint), 1) << server.log();
    expect_serving();
    EXPECT_EQ(server.stop(), 0) << server.log();
  }
}

}  // namespace
}  // namespace bpa
