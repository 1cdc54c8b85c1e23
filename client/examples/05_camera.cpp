// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A camera driver as a ROS 2 node would be one: colour image, depth image and camera info on three
// topics, which rviz2 and `ros2 topic hz` see as well. Here the camera looks at a wall. It ends
// after the number of frames that it is given; 0 is never.

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

#include <bpa/wire/messages.hpp>
#include <bpa/wire/publisher.hpp>

namespace wire = bpa::wire;
using wire::sensor_msgs::CameraInfo;
using wire::sensor_msgs::Image;

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main(int argc, char** argv) {
  const long frames = argc > 1 ? std::atol(argv[1]) : 0;
  wire::ParticipantOptions options;  // domain and range from ROS_DOMAIN_ID and so on
  options.node = {"/camera", "driver"};
  const auto node = wire::Participant::create(options);
  if (!node.ok()) return fail(node.status().message);
  auto color = wire::Publisher<Image>::create(*node, "color/image_raw");
  auto depth = wire::Publisher<Image>::create(*node, "aligned_depth_to_color/image_raw");
  auto info = wire::Publisher<CameraInfo>::create(*node, "color/camera_info");
  if (!color.ok() || !depth.ok() || !info.ok()) return fail("cannot publish");

  Image rgb, millimetres;
  CameraInfo camera;
  rgb.width = millimetres.width = camera.width = 640;
  rgb.height = millimetres.height = camera.height = 480;
  rgb.encoding = "rgb8";
  rgb.step = 3 * rgb.width;
  rgb.data.assign(std::size_t{rgb.step} * rgb.height, 128);
  millimetres.encoding = "16UC1";
  millimetres.step = 2 * millimetres.width;
  for (std::size_t i = 0; i < 640 * 480; ++i) {  // 800 mm, little-endian
    millimetres.data.push_back(800 & 0xff);
    millimetres.data.push_back(800 >> 8);
  }
  camera.distortion_model = "plumb_bob";
  camera.d = {0, 0, 0, 0, 0};
  camera.k = {525, 0, 319.5, 0, 525, 239.5, 0, 0, 1};
  camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.p = {525, 0, 319.5, 0, 0, 525, 239.5, 0, 0, 0, 1, 0};

  std::cout << "publishing on " << color->topic() << std::endl;
  auto next = std::chrono::steady_clock::now();
  for (long i = 0; frames == 0 || i < frames; ++i) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    const wire::std_msgs::Header header{wire::builtin_interfaces::from_ns(ns),
                                        "camera_color_optical_frame"};
    rgb.header = millimetres.header = camera.header = header;
    for (const auto& status :
         {info->publish(camera), color->publish(rgb), depth->publish(millimetres)}) {
      if (!status.ok()) std::cerr << status.message << '\n';
    }
    std::this_thread::sleep_until(next += std::chrono::milliseconds(33));
  }
}

// Expected output:
//   publishing on /camera/color/image_raw
