// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/cloud/blur.hpp"
#include "core/cloud/cielab.hpp"
#include "core/features/edges.hpp"
#include "core/segment/super_pixels.hpp"

namespace bpa {
namespace {

// A 640x480 frame without gaps: a slanted table with a field of noisy, coloured balls on it.
Frame ball_field() {
  Frame frame;
  frame.camera = {640, 480, 525, 525, 319.5, 239.5};
  RandomStream random(1);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double table = 1.4 - 0.0012 * v;
      const double x = std::remainder(u, 90.0), y = std::remainder(v, 90.0);
      const double bulge = 1600 - x * x - y * y;  // 40 pixels in radius
      const double z = table - (bulge > 0 ? 0.002 * std::sqrt(bulge) + 0.01 : 0);
      frame.depth.push_back(static_cast<float>(z + 0.002 * random.normal()));
      const int ball = (u + 45) / 90 + 8 * ((v + 45) / 90);
      for (int k = 0; k < 3; ++k) {
        const double value = bulge > 0 ? 40 + (ball * (37 + 20 * k)) % 180 : 120;
        frame.color.push_back(
            static_cast<std::uint8_t>(std::clamp(value + 6 * random.normal(), 0.0, 255.0)));
      }
    }
  }
  return frame;
}

// Everything the detector adds for edges: colours at the map's size, three masks, the edge image.
void edge_image_640x480(benchmark::State& state) {
  const Frame frame = ball_field();
  const SurfaceMap map = surface_map(frame, {});
  features::EdgeImageOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const auto rgb = reduced_color(frame, map, options.num_threads);
    benchmark::DoNotOptimize(features::scene_edges(map, rgb, options));
  }
}
BENCHMARK(edge_image_640x480)
    ->Name("features/edge_image")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// Blurred CIELAB colours and the super-pixels themselves.
void super_pixels_640x480(benchmark::State& state) {
  const Frame frame = ball_field();
  const SurfaceMap map = surface_map(frame, {});
  segment::SuperPixelOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  const auto rgb = reduced_color(frame, map, 0);
  const features::SceneEdges edges = features::scene_edges(map, rgb);
  for (auto _ : state) {
    const auto lab = cielab(blur(rgb, 1.5, options.num_threads), options.num_threads);
    benchmark::DoNotOptimize(segment::super_pixels(map, lab, edges.likelihood, options));
  }
}
BENCHMARK(super_pixels_640x480)
    ->Name("segment/super_pixels")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace bpa
