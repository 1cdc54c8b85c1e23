// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Search a frame of your own: here a made-up wall that fills the view, 0.8 m away.

#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <bpa/client.hpp>

int fail(const std::string& message) {
  std::cerr << message << '\n';
  return 1;
}

int main() {
  const std::vector<std::uint16_t> depth_mm(640 * 480, 800);
  bpa::FrameView frame;
  frame.width = 640;
  frame.height = 480;
  frame.depth_mm = depth_mm.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;

  auto client = bpa::Client::connect();
  if (!client.ok()) return fail(client.status().message);
  const auto found = client->detect_in(frame);
  if (!found.ok()) return fail(found.status().message);
  std::cout << found->best().size() << " objects in " << found->total_ms << " ms\n";
}

// Expected output with the server of the tests, which finds one object, "stub", in every frame:
//   1 objects in 0 ms
