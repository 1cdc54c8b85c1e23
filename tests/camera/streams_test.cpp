// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Clocks, pairs, modes and USB: the small parts of the camera driver.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "camera/open_camera.hpp"
#include "camera/stamps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::camera {
namespace {

TEST(HostClock, StampsStayEvenWhateverDelaysTheirArrival) {
  // A device clock that runs 40 millionths fast, frames that arrive 5 to 45 ms late.
  HostClock clock;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> delay(5e6, 45e6);
  constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const double exposed_ns = i * 33'333'333.0;
    const auto device_us = static_cast<std::int64_t>(7e6 + exposed_ns * 1.00004 / 1000);
    const auto arrival = kStart + static_cast<std::int64_t>(exposed_ns + delay(random));
    const std::int64_t mapped = clock.map(device_us, arrival);
    EXPECT_LE(mapped, arrival);
    if (i < 100) continue;  // until it has seen a short delay
    const double off = static_cast<double>(mapped - kStart) - exposed_ns - 5e6;
    worst = std::max(worst, std::abs(off));
  }
  EXPECT_LT(worst, 3e6);  // 3 ms, of delays of 40 ms; the shortest delay cannot be seen
}

TEST(HostClock, StartsAgainWhenTheDeviceDoes) {
  HostClock clock;
  EXPECT_EQ(clock.map(1'000'000, 50'000'000'000), 50'000'000'000);
  EXPECT_EQ(clock.map(1'033'000, 50'033'000'000), 50'033'000'000);
  EXPECT_EQ(clock.map(0, 60'000'000'000), 60'000'000'000);       // a recording begins again
  EXPECT_EQ(clock.map(33'000, 63'000'000'000), 63'000'000'000);  // it was held up for long
  EXPECT_EQ(clock.map(66'000, 63'050'000'000), 63'033'003'300);  // 17 ms late but for the drift
}

using Pairs = FramePairs<int>;

TEST(FramePairs, PairsTheFramesOfOneMoment) {
  Pairs pairs(1000);
  pairs.add_depth(1, 10'000);
  EXPECT_FALSE(pairs.take());
  pairs.add_color(2, 10'900);
  const auto pair = pairs.take();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->depth, 1);
  EXPECT_EQ(pair->color, 2);
  EXPECT_FALSE(pairs.take());
}

TEST(FramePairs, DropsWhatFindsNoPartner) {
  Pairs pairs(1000);
  pairs.add_color(1, 10'000);
  pairs.add_depth(2, 20'000);
  EXPECT_FALSE(pairs.take());  // the colour image is too old
  pairs.add_color(3, 20'000);
  EXPECT_EQ(pairs.take()->color, 3);
  pairs.add_depth(4, 30'000);
  pairs.add_depth(5, 40'000);
  pairs.add_color(6, 40'000);
  EXPECT_EQ(pairs.take()->depth, 5);
  pairs.add_depth(7, 50'000);
  pairs.add_color(8, 60'000);
  EXPECT_FALSE(pairs.take());
}

TEST(VideoMode, ReadsAndWrites) {
  const auto mode = parse_video_mode("640x480@30");
  ASSERT_TRUE(mode);
  EXPECT_EQ(to_string(*mode), "640x480@30");
  for (const char* wrong : {"", "640x480", "640x480@", "640@30", "x480@30", "640x480@30 ",
                            "0x480@30", "640x480@-3", "99999x480@30", "640 x480@30"}) {
    EXPECT_FALSE(parse_video_mode(wrong)) << wrong;
  }
  EXPECT_EQ(list_of({*mode, {320, 240, 15}, *mode}), "640x480@30, 320x240@15");
}

TEST(UsbSensors, TellsWhatIsPluggedInAndHowToUseIt) {
  const test::TemporaryFolder folder;
  const auto plug = [&](const std::string& place, const char* vendor, const char* product) {
    test::spill(folder / ("sys/" + place + "/idVendor"), std::string(vendor) + "\n");
    test::spill(folder / ("sys/" + place + "/idProduct"), std::string(product) + "\n");
    test::spill(folder / ("sys/" + place + "/busnum"), "1\n");
    test::spill(folder / ("sys/" + place + "/devnum"), "7\n");
  };
  plug("1-2", "045e", "02ae");
  plug("1-3", "1d27", "0601");
  plug("1-4", "8086", "0b07");
  plug("1-5", "046d", "c52b");  // a mouse
  test::spill(folder / "dev/001/007", "");
  const auto sensors = usb_sensors(folder / "sys", folder / "dev");
  ASSERT_EQ(sensors.size(), 3U);
  EXPECT_EQ(sensors[0].name, "Kinect v1");
  EXPECT_NE(sensors[0].how.find("freenect"), std::string::npos);
  EXPECT_TRUE(sensors[0].openni2 && sensors[1].openni2);
  EXPECT_EQ(sensors[1].id, "1d27:0601");
  EXPECT_FALSE(sensors[2].openni2);
  EXPECT_NE(sensors[2].how.find("ROS 2"), std::string::npos);
  EXPECT_TRUE(sensors[0].permitted);
  EXPECT_TRUE(usb_sensors(folder / "none", folder / "dev").empty());
}

TEST(BopCamera, AMissingFolderIsNotFound) {
  EXPECT_EQ(open_bop_camera("/nowhere", {}).status().code, StatusCode::not_found);
}

}  // namespace
}  // namespace bpa::camera
