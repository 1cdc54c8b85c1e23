// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Frame in to result out, and how much of that is not the search: a frame from the SDK through a
// server and back, both over UDP. With a library, bpa-server searches the frames of a data set in
// the BOP layout; without, bpa-stub-server answers a 640x480 frame with a fixed result.
// usage: bpa-server-latency [FRAMES [LIBRARY DATASET]]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <utility>
#include <vector>

#include "client/cli/convert.hpp"
#include "core/base/failure.hpp"
#include "core/io/bop_dataset.hpp"
#include "tests/support/stub_server.hpp"

namespace {

using Clock = std::chrono::steady_clock;

/// A frame as a Kinect's driver publishes it: depth in millimetres.
struct Shot {
  bpa::Frame frame;
  std::vector<std::uint16_t> depth_mm;

  explicit Shot(bpa::Frame shot) : frame(std::move(shot)) {
    for (const float z : frame.depth) {
      depth_mm.push_back(static_cast<std::uint16_t>(std::lround(1000 * z)));
    }
  }
  bpa::FrameView view(std::int64_t stamp_ns) const {
    bpa::FrameView view = bpa::cli::view_of(frame);
    view.depth_m = nullptr;
    view.depth_mm = depth_mm.data();
    view.stamp_ns = stamp_ns;
    return view;
  }
};

Shot plain_shot() {
  bpa::Frame frame;
  frame.camera = {640, 480, 525, 525, 319.5, 239.5};
  frame.depth.assign(640 * 480, 0.9f);
  frame.color.assign(3 * 640 * 480, 90);
  return Shot(std::move(frame));
}

std::vector<Shot> shots_of(const char* dataset) {
  std::vector<Shot> shots;
  for (const auto& entry : bpa::or_throw(bpa::io::read_bop_frames(dataset, "test", {}))) {
    shots.emplace_back(bpa::or_throw(bpa::io::load_bop_frame(entry)));
  }
  return shots;
}

void print(const char* name, std::vector<double> times_ms) {
  std::ranges::sort(times_ms);
  std::printf("%-20s median %.2f ms, min %.2f, 99 %% %.2f, max %.2f\n", name,
              times_ms[times_ms.size() / 2], times_ms.front(), times_ms[times_ms.size() * 99 / 100],
              times_ms.back());
}

void measure(int count, const std::vector<Shot>& shots) {
  std::mutex mutex;
  std::condition_variable changed;
  bpa::DetectionSet last;
  bpa::Client client = bpa::or_throw(bpa::Client::connect(bpa::support::client_options()));
  bpa::or_throw(client.subscribe([&](const bpa::DetectionSet& set) {
    const std::lock_guard<std::mutex> lock(mutex);
    last = set;
    changed.notify_all();
  }));

  constexpr int kWarmUp = 20;
  std::vector<double> whole_ms, outside_ms;
  for (int i = 0; i < kWarmUp + count; ++i) {
    const bpa::FrameView frame = shots[i % shots.size()].view(1000 + i);
    const auto start = Clock::now();
    bpa::or_throw(client.publish_frame(frame));
    std::unique_lock<std::mutex> lock(mutex);
    const bool came = changed.wait_for(lock, std::chrono::seconds(5),
                                       [&] { return last.stamp_ns == frame.stamp_ns; });
    const std::chrono::duration<double, std::milli> time = Clock::now() - start;
    if (i < kWarmUp || !came) continue;
    whole_ms.push_back(time.count());
    outside_ms.push_back(time.count() - last.total_ms);
  }
  std::printf("%d frames, %zu lost\n", count, count - whole_ms.size());
  if (whole_ms.empty()) return;
  print("frame to result", whole_ms);
  print("without the search", outside_ms);
}

void run(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 1000;
  if (argc < 4) {
    const bpa::support::StubServer server;
    return measure(count, {plain_shot()});
  }
  const bpa::support::Process server(
      bpa::support::own_command("bpa-server",
                                {"--library", argv[2], "--set", "detection.follow=false"}),
      bpa::support::scratch_folder() + "/server.log");
  measure(count, shots_of(argv[3]));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
  } catch (const std::exception& failure) {
    return std::fprintf(stderr, "%s\n", failure.what()), 1;
  }
}
