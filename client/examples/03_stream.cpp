// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Publish frames to the server's stream and print what it finds in them, as it comes.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <bpa/client.hpp>

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main() {
  std::atomic<int> answers{0};
  auto client = bpa::Client::connect();
  if (!client.ok()) return fail(client.status().message);
  const bpa::Status status = client->subscribe([&](const bpa::DetectionSet& set) {
    std::cout << "frame " << set.stamp_ns << ": " << set.best().size() << " objects\n";
    ++answers;
  });
  if (!status.ok()) return fail(status.message);

  const std::vector<std::uint16_t> depth_mm(640 * 480, 800);
  bpa::FrameView frame;
  frame.width = 640;
  frame.height = 480;
  frame.depth_mm = depth_mm.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;
  for (frame.stamp_ns = 1; frame.stamp_ns <= 3; ++frame.stamp_ns) {
    const bpa::Status sent = client->publish_frame(frame);
    if (!sent.ok()) return fail(sent.message);
    while (answers < frame.stamp_ns) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   frame 1: 1 objects
//   frame 2: 1 objects
//   frame 3: 1 objects
