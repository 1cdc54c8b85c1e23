// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// usage: bpa-frame-caller DOMAIN NAMESPACE CALLS TIMEOUT_MS [stream]. Asks a server about frames of
// 640 x 480, one after the other; with `stream` publishes each beforehand, too. Prints how many
// were answered; exits 1 unless all were.
#include <cstdlib>
#include <iostream>
#include <vector>

#include <bpa/client.hpp>

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) return 2;
  bpa::ClientOptions options;
  options.domain = std::atoi(argv[1]);
  options.server_namespace = argv[2];
  options.range_from_environment = false;
  options.range = bpa::DiscoveryRange::localhost;
  options.timeout = std::chrono::milliseconds(20000);
  auto client = bpa::Client::connect(options);
  if (!client.ok()) {
    std::cout << client.status().message << '\n';
    return 1;
  }
  const std::vector<std::uint8_t> rgb(3 * 640 * 480, 9);
  const std::vector<std::uint16_t> depth(640 * 480, 1000);
  bpa::FrameView frame;
  frame.width = 640;
  frame.height = 480;
  frame.rgb = rgb.data();
  frame.depth_mm = depth.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;
  const int calls = std::atoi(argv[3]);
  int answered = 0;
  for (int i = 0; i < calls; ++i) {
    if (argc == 6) (void)client->publish_frame(frame);
    const auto found = client->detect_in(frame, {}, std::chrono::milliseconds(std::atoi(argv[4])));
    if (found.ok()) {
      ++answered;
    } else {
      std::cout << found.status().message << '\n';
    }
  }
  std::cout << answered << " of " << calls << " were answered\n";
  return answered == calls ? 0 : 1;
}
