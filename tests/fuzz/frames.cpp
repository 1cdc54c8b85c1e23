// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Frames, images and clouds of messages, as the server takes them.
#include "ros/frames.hpp"

#include "idl/wire/cdr.hpp"
#include "server/sources/frame_source.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::fuzz {
namespace {

namespace msgs = wire::bpa_msgs;
namespace sensor = wire::sensor_msgs;

// The smallest image that has as many depths as a frame must have.
constexpr std::uint32_t kColumns = 32, kRows = 16;

template <class T>
std::string encoded(const T& message) {
  const std::vector<std::uint8_t> bytes = wire::encode(message);
  return {bytes.begin(), bytes.end()};
}

template <class T>
bool decoded(std::string_view bytes, T& message) {
  return wire::decode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), message)
      .ok();
}

/// What the detector relies on.
void check(const ros::DecodedFrame& frame) {
  if (!frame.ok()) return;
  require(validate(*frame).ok(), "a frame of a message is legal");
  for (const float z : frame->depth) require(z >= 0 && z <= 20, "a depth is 0 to 20 m");
}

void run_rgbd_frame(std::string_view bytes) {
  msgs::RgbdFrame message;
  if (!decoded(bytes, message)) return;
  (void)ros::priors_from_messages(message.priors);
  auto frame = ros::frame_from_message(message);
  check(frame);
  if (frame.ok() && ros::restrict_frame(message, *frame).ok()) {
    require(validate(*frame).ok(), "a restricted frame is legal");
  }
}

msgs::RgbdFrame small_frame() {
  msgs::RgbdFrame frame = support::wall_frame();
  frame.width = kColumns;
  frame.height = kRows;
  frame.color.resize(3 * kColumns * kRows);
  frame.depth.resize(2 * kColumns * kRows);
  return frame;
}

std::vector<std::string> rgbd_frame_seeds() {
  msgs::RgbdFrame frame = small_frame();
  std::vector<std::string> seeds = {encoded(frame)};
  frame.d = {0.1, -0.01, 0.001, 0.001, 0.1};
  frame.mask.assign(kColumns * kRows, 1);
  frame.priors.resize(1);
  frame.priors[0].model = "mug";
  frame.priors[0].position_covariance = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  frame.color.clear();
  frame.color_encoding.clear();
  seeds.push_back(encoded(frame));
  frame.depth_encoding = "32FC1";
  frame.depth.assign(4 * kColumns * kRows, 0x3f);
  seeds.push_back(encoded(frame));
  return seeds;
}

/// The three messages of a camera, one behind the other in one encoding.
struct CameraMessages {
  sensor::CameraInfo info;
  sensor::Image depth, color;
  bool rectified = false;

  static constexpr const char* kType = "camera messages";
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("rectified", self.rectified);
    visit("info", self.info);
    visit("depth", self.depth);
    visit("color", self.color);
  }
};

void run_camera_images(std::string_view bytes) {
  CameraMessages messages;
  if (!decoded(bytes, messages)) return;
  ros::CameraImages images;
  images.info = std::make_shared<sensor::CameraInfo>(messages.info);
  images.depth = std::make_shared<ros::AnyImage>(messages.depth);
  if (!messages.color.data.empty()) images.color = std::make_shared<ros::AnyImage>(messages.color);
  check(ros::frame_from_images(images, messages.rectified));
}

std::vector<std::string> camera_images_seeds() {
  CameraMessages messages{support::wall_camera_info(1), support::wall_depth_image(1),
                          support::wall_color_image(1)};
  messages.info.width = messages.depth.width = messages.color.width = kColumns;
  messages.info.height = messages.depth.height = messages.color.height = kRows;
  messages.depth.step = 2 * kColumns;
  messages.depth.data.resize(std::size_t{messages.depth.step} * kRows);
  messages.color.step = 3 * kColumns;
  messages.color.data.resize(std::size_t{messages.color.step} * kRows);
  std::vector<std::string> seeds = {encoded(messages)};
  messages.rectified = true;
  messages.depth.is_bigendian = 1;
  messages.color.encoding = "mono8";
  messages.color.step = kColumns;
  messages.color.data.resize(kColumns * kRows);
  seeds.push_back(encoded(messages));
  return seeds;
}

void run_point_cloud(std::string_view bytes) {
  sensor::PointCloud2 cloud;
  if (decoded(bytes, cloud)) check(ros::frame_from_cloud(cloud));
}

std::vector<std::string> point_cloud_seeds() {
  const auto frame = ros::frame_from_message(small_frame());
  require(frame.ok(), "a seed is legal");
  return {encoded(server::cloud_message(*frame))};
}

}  // namespace

std::vector<Target> frame_targets() {
  const char* const frames = "ros/frames.cpp ros/images.cpp";
  return {{"rgbd_frame", frames, run_rgbd_frame, rgbd_frame_seeds, 8192},
          {"camera_images", frames, run_camera_images, camera_images_seeds, 8192},
          {"point_cloud", "ros/clouds.cpp core/io/organised_cloud.cpp", run_point_cloud,
           point_cloud_seeds, 16384}};
}

}  // namespace bpa::fuzz
