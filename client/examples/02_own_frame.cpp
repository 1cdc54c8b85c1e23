// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Search a frame of your own: a 16-bit depth image in millimetres, and a colour image of the same
// size and view. OpenCV reads them; the SDK does not need it.

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <bpa/client.hpp>

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 7) return fail("usage: 02_own_frame DEPTH.png COLOR.png FX FY CX CY");
  const cv::Mat depth = cv::imread(argv[1], cv::IMREAD_UNCHANGED);
  cv::Mat color = cv::imread(argv[2]);
  if (depth.type() != CV_16UC1) return fail(std::string(argv[1]) + " is no 16-bit image");
  if (color.size() != depth.size()) return fail("depth and colour differ in size");
  cv::cvtColor(color, color, cv::COLOR_BGR2RGB);

  bpa::FrameView frame;  // the pixels stay where they are
  frame.width = depth.cols;
  frame.height = depth.rows;
  frame.depth_mm = depth.ptr<std::uint16_t>();
  frame.rgb = color.data;
  frame.fx = std::atof(argv[3]);
  frame.fy = std::atof(argv[4]);
  frame.cx = std::atof(argv[5]);
  frame.cy = std::atof(argv[6]);

  auto client = bpa::Client::connect();
  if (!client.ok()) return fail(client.status().message);
  const auto found = client->detect_in(frame);
  if (!found.ok()) return fail(found.status().message);
  for (const bpa::Detection& d : found->best()) {
    const auto& p = d.camera_from_object.position;
    std::cout << d.model << ": " << 100 * d.probability << " % at " << p[0] << ' ' << p[1] << ' '
              << p[2] << " m\n";
  }
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   stub: 87.5 % at 0 0 0.8 m
