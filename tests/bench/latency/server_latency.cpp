// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Frame in to result out with detection replaced by a no-op: a 640x480 colour and depth frame from
// the SDK through bpa-stub-server and back. usage: bpa-server-latency [frames]
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "tests/support/stub_server.hpp"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  bpa::support::StubServer server;
  std::mutex mutex;
  std::condition_variable changed;
  std::int64_t last_stamp = 0;
  auto client = bpa::Client::connect(bpa::support::client_options());
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().message.c_str()), 1;

  const bpa::Status status = client->subscribe([&](const bpa::DetectionSet& set) {
    const std::lock_guard<std::mutex> lock(mutex);
    last_stamp = set.stamp_ns;
    changed.notify_all();
  });
  if (!status.ok()) return std::fprintf(stderr, "%s\n", status.message.c_str()), 1;

  const std::vector<std::uint16_t> depth(640 * 480, 900);
  const std::vector<std::uint8_t> rgb(3 * 640 * 480, 90);
  bpa::FrameView frame;
  frame.width = 640;
  frame.height = 480;
  frame.depth_mm = depth.data();
  frame.rgb = rgb.data();
  frame.fx = frame.fy = 525;
  frame.cx = 319.5;
  frame.cy = 239.5;
  std::vector<double> times_ms;
  int lost = 0;
  for (int i = -50; i < count; ++i) {  // the first ones warm up
    frame.stamp_ns = 1000 + i;
    const auto start = Clock::now();
    if (!client->publish_frame(frame).ok()) return 1;
    std::unique_lock<std::mutex> lock(mutex);
    const bool came = changed.wait_for(lock, std::chrono::seconds(2),
                                       [&] { return last_stamp == frame.stamp_ns; });
    const std::chrono::duration<double, std::milli> time = Clock::now() - start;
    if (i < 0) continue;
    lost += came ? 0 : 1;
    if (came) times_ms.push_back(time.count());
  }
  std::sort(times_ms.begin(), times_ms.end());
  if (times_ms.empty()) return 1;
  std::printf("%zu frames, %d lost: median %.2f ms, min %.2f, 99 %% %.2f, max %.2f\n",
              times_ms.size(), lost, times_ms[times_ms.size() / 2], times_ms.front(),
              times_ms[times_ms.size() * 99 / 100], times_ms.back());
}
