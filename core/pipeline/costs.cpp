// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/costs.hpp"

#include <algorithm>
#include <limits>

#include "core/base/stopwatch.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {
namespace {

constexpr double kNew = 0.5;  // weight of the newest frame: machines get busy within a few frames

// A whole preparation, of the work of its surface map. A first guess, until a frame is measured.
constexpr double kPreparation = 6;

constexpr int kTimed = 3;  // the first frames of a process wait for pages and threads

// The surface map of a slanted plane, milliseconds for each pixel.
double surface_ms_per_pixel(int threads) {
  Frame frame;
  frame.camera = {160, 120, 140, 140, 79.5, 59.5};
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u) {
      frame.depth.push_back(0.8f + 0.001f * static_cast<float>(u + v));
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTimed; ++i) {
    const Stopwatch watch;
    const SurfaceMap map = surface_map(frame, {.num_threads = threads});
    least = std::min(least, watch.milliseconds() / static_cast<double>(map.size()));
  }
  return least;
}

void mix(double measured, double& mean) {
  if (measured > 0) mean = mean > 0 ? (1 - kNew) * mean + kNew * measured : measured;
}

}  // namespace

Costs CostMeter::costs(std::size_t pixels, int threads) {
  const std::lock_guard lock(mutex_);
  Costs& mean = means_[{pixels, threads}];
  if (mean.preparation_ms == 0) {
    mean.preparation_ms =
        kPreparation * surface_ms_per_pixel(threads) * static_cast<double>(pixels);
  }
  return mean;
}

void CostMeter::add(std::size_t pixels, int threads, const Costs& measured) {
  const std::lock_guard lock(mutex_);
  Costs& mean = means_[{pixels, threads}];
  mix(measured.preparation_ms, mean.preparation_ms);
  mix(measured.round_share, mean.round_share);
  mix(measured.final_share, mean.final_share);
}

}  // namespace bpa
