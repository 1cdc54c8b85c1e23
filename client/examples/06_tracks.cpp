// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Follows objects from frame to frame: each keeps its id and its name. Here the frames are our own,
// and the first object that is confirmed gets a name.

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
  std::atomic<int> confirmed{0};
  std::string last;
  auto client = bpa::Client::connect();  // calls back until it is destroyed: after the above
  if (!client.ok()) return fail(client.status().message);

  const auto subscribed = client->tracks([&](const bpa::TrackSet& set) {
    for (const bpa::TrackedObject& object : set.tracks) {
      const std::string line = std::to_string(object.id) + ' ' + object.name + ' ' + object.model +
                               ' ' + bpa::to_string(object.state);
      if (line != last) std::cout << line << std::endl;
      last = line;
      if (object.state == bpa::TrackedState::confirmed) confirmed = 1;
      if (object.name == "mine") confirmed = 2;
    }
  });
  if (!subscribed.ok()) return fail(subscribed.message);

  const std::vector<std::uint16_t> depth(640 * 480, 800);  // mm: a wall
  bpa::FrameView frame;
  frame.width = 640;
  frame.height = 480;
  frame.depth_mm = depth.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;
  bool renamed = false;
  for (frame.stamp_ns = 33'000'000; confirmed < 2; frame.stamp_ns += 33'000'000) {
    const auto sent = client->publish_frame(frame);
    if (!sent.ok()) return fail(sent.message);
    if (confirmed == 1 && !renamed) {
      const auto status = client->rename_track("1", "mine");  // by its id
      if (!status.ok()) return fail(status.message);
      renamed = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
  }
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   1 stub_1 stub confirmed
//   1 mine stub confirmed
