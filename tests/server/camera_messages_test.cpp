// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What the images of the server's own camera look like as messages.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "idl/wire/time.hpp"
#include "server/sources/frame_source.hpp"

namespace bpa::server {
namespace {

TEST(ImageMessages, SayTheFormatSizeCameraAndTime) {
  camera::SensorImages images;
  images.stamp_ns = 12'000'000'034;
  images.camera = {4, 3, 30, 31, 1.5, 1.25};
  images.distortion = {0.1, 0.2};
  images.depth = {camera::PixelFormat::depth_mm, 4, 3, std::vector<std::uint8_t>(24, 5)};
  images.color = camera::Image{camera::PixelFormat::grey, 4, 3, std::vector<std::uint8_t>(12, 6)};
  const ros::CameraImages messages = image_messages(images, "optical");
  const auto& depth = std::get<wire::sensor_msgs::Image>(*messages.depth);
  EXPECT_EQ(to_ns(depth.header.stamp), 12'000'000'034);
  EXPECT_EQ(depth.header.frame_id, "optical");
  EXPECT_EQ(depth.encoding, "16UC1");
  EXPECT_EQ(depth.step, 8U);
  EXPECT_EQ(depth.data, images.depth.bytes);
  const auto& color = std::get<wire::sensor_msgs::Image>(*messages.color);
  EXPECT_EQ(color.encoding, "mono8");
  EXPECT_EQ(color.step, 4U);
  EXPECT_EQ(messages.info->width, 4U);
  EXPECT_EQ(messages.info->height, 3U);
  EXPECT_EQ(messages.info->distortion_model, "plumb_bob");
  EXPECT_EQ(messages.info->d, (std::vector<double>{0.1, 0.2, 0, 0, 0}));
  EXPECT_EQ(messages.info->k[0], 30);
  EXPECT_EQ(messages.info->k[4], 31);
  EXPECT_EQ(messages.info->p[6], 1.25);
}

TEST(CloudMessage, HoldsEveryPixelWhereTheCameraSeesIt) {
  Frame frame;
  frame.camera = {32, 24, 30, 31, 15.5, 11.5};
  frame.depth.assign(32 * 24, 1.5f);
  frame.depth[33] = 0;
  frame.color.assign(3 * 32 * 24, 0);
  frame.color[3 * 40] = 200;    // red
  frame.color[3 * 40 + 2] = 7;  // blue
  frame.stamp_ns = 12;
  const auto cloud = cloud_message(frame);
  EXPECT_EQ(cloud.width, 32U);
  EXPECT_EQ(cloud.height, 24U);
  EXPECT_EQ(cloud.data.size(), 16U * 32 * 24);
  const auto number = [&](std::size_t pixel, std::size_t field) {
    float value = 0;
    std::memcpy(&value, cloud.data.data() + 16 * pixel + 4 * field, sizeof value);
    return value;
  };
  EXPECT_TRUE(std::isnan(number(33, 0)) && std::isnan(number(33, 2)));
  EXPECT_FLOAT_EQ(number(40, 0), static_cast<float>((8 - 15.5) / 30 * 1.5));
  EXPECT_FLOAT_EQ(number(40, 1), static_cast<float>((1 - 11.5) / 31 * 1.5));
  EXPECT_EQ(cloud.data[16 * 40 + 14], 200);
  EXPECT_EQ(cloud.data[16 * 40 + 12], 7);
  // Our own reader of clouds finds the camera again.
  frame.depth[33] = 1.5f;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) frame.depth[i] += 0.01f * float(i % 7);
  const auto back = ros::frame_from_cloud(cloud_message(frame));
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_NEAR(back->camera.fx, 30, 0.01);
  EXPECT_EQ(back->color, frame.color);
}

}  // namespace
}  // namespace bpa::server
