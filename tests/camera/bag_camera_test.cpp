// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "camera/open_camera.hpp"
#include "core/base/clock.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wall_bag.hpp"

namespace bpa::camera {
namespace {

using std::chrono::milliseconds;

/// The next images; those that come later are waited for.
SensorImages images_of(CameraDevice& camera) {
  while (true) {
    auto output = camera.next(milliseconds(100));
    EXPECT_TRUE(output.ok()) << output.status().message;
    if (!output.ok() || output->ended) return {};
    if (output->images) return *std::move(output->images);
  }
}

TEST(BagCamera, PlaysInItsOwnTimeFromNow) {
  const test::TemporaryFolder folder;
  test::spill(folder / "a.mcap", support::mcap_of(support::recording(), support::McapKind::lz4));
  CameraOptions options;
  options.source = "bag:" + (folder / "a.mcap");
  options.speed = 50;
  std::vector<std::int64_t> transforms;
  const auto open = camera_of(options, nullptr, [&](const auto& message, bool is_static) {
    EXPECT_TRUE(is_static);
    transforms.push_back(to_ns(message.transforms[0].header.stamp));
  });
  ASSERT_TRUE(open.ok()) << open.status().message;
  const std::int64_t before = unix_time_ns();
  auto camera = (*open)();
  ASSERT_TRUE(camera.ok()) << camera.status().message;
  const SensorImages first = images_of(**camera);
  EXPECT_GE(first.stamp_ns, before);
  EXPECT_LE(first.stamp_ns, unix_time_ns());
  EXPECT_EQ(first.frame_id, "wall_camera");
  EXPECT_EQ(first.camera.fx, 60);
  EXPECT_EQ(first.color->bytes, support::wall_rgb());
  EXPECT_EQ(transforms.size(), 1U);
  const SensorImages second = images_of(**camera);
  EXPECT_EQ(second.stamp_ns - first.stamp_ns, 20'000'000);  // a second, 50 times as fast
  EXPECT_GE(unix_time_ns(), second.stamp_ns);
}

TEST(BagCamera, TransformsKeepTheirTimeBesideTheFrames) {
  auto messages = support::recording();  // begins with a static one of stamp 0
  auto moving = support::transform();
  moving.transforms[0].header.stamp =
      wire::builtin_interfaces::from_ns(support::kSecond - 30'000'000);
  messages.insert(messages.begin() + 1, support::recorded("/tf", support::kSecond, moving));
  const test::TemporaryFolder folder;
  test::spill(folder / "a.mcap", support::mcap_of(messages, support::McapKind::plain));
  CameraOptions options;
  options.source = "bag:" + (folder / "a.mcap");
  std::vector<std::int64_t> stamps;
  auto camera = open_bag_camera(options, [&](const auto& message, bool is_static) {
    if (!is_static) stamps.push_back(to_ns(message.transforms[0].header.stamp));
  });
  ASSERT_TRUE(camera.ok()) << camera.status().message;
  const SensorImages first = images_of(**camera);
  ASSERT_EQ(stamps.size(), 1U);
  EXPECT_EQ(first.stamp_ns - stamps[0], 30'000'000);
}

TEST(BagCamera, BeginsWhereItShouldAndRepeats) {
  const test::TemporaryFolder folder;
  support::write_db3(folder / "a.db3", support::recording(2));
  CameraOptions options;
  options.source = "bag:" + folder.path();
  options.every_frame = true;
  options.start_frame = 2;
  auto camera = open_bag_camera(options, nullptr);
  ASSERT_TRUE(camera.ok()) << camera.status().message;
  EXPECT_TRUE((*camera)->next(milliseconds(0))->images);
  EXPECT_TRUE((*camera)->next(milliseconds(0))->ended);
  options.loop = true;
  camera = open_bag_camera(options, nullptr);
  const SensorImages first = images_of(**camera), again = images_of(**camera);
  EXPECT_EQ(first.depth.bytes, again.depth.bytes);
  EXPECT_GE(again.stamp_ns, first.stamp_ns);
  options.start_frame = 3;
  EXPECT_EQ(open_bag_camera(options, nullptr).status().code, StatusCode::invalid_argument);
}

TEST(BagCamera, TopicsAreChecked) {
  const test::TemporaryFolder folder;
  support::write_db3(folder / "a.db3", support::recording());
  CameraOptions options;
  options.source = "bag:" + folder.path();
  options.bag_topics.depth = "/camera/none";
  const auto camera = open_bag_camera(options, nullptr);
  EXPECT_NE(camera.status().message.find("/camera/none"), std::string::npos);
  EXPECT_NE(camera.status().message.find("/camera/depth (sensor_msgs/msg/Image)"),
            std::string::npos)
      << camera.status().message;
}

}  // namespace
}  // namespace bpa::camera
