// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/costs.hpp"

#include "core/base/stopwatch.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {
namespace {

constexpr double kNew = 0.5;  // weight of the newest frame: machines get busy within a few frames

// A whole preparation, of the work of its surface map. A first guess, until a frame is measured.
constexpr double kPreparation = 6;

// Microseconds for each pixel of a frame, of the surface map of a slanted plane.
double surface_us_per_pixel(int threads) {
  Frame frame;
  frame.camera = {160, 120, 140, 140, 79.5, 59.5};
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u) {
      frame.depth.push_back(0.8f + 0.001f * static_cast<float>(u + v));
    }
  }
  const Stopwatch watch;
  const SurfaceMap map = surface_map(frame, {.num_threads = threads});
  return 1000 * watch.milliseconds() / static_cast<double>(map.size());
}

void mix(double measured, double& mean) {
  if (measured > 0) mean = mean > 0 ? (1 - kNew) * mean + kNew * measured : measured;
}

}  // namespace

Costs CostMeter::costs(std::size_t pixels, int threads) {
  const std::lock_guard lock(mutex_);
  Means& means = means_[threads];
  if (means.preparation_us_per_pixel == 0) {
    means.preparation_us_per_pixel = kPreparation * surface_us_per_pixel(threads);
  }
  Costs out = means.shares;
  out.preparation_ms = means.preparation_us_per_pixel * static_cast<double>(pixels) / 1000;
  return out;
}

void CostMeter::add(std::size_t pixels, int threads, const Costs& measured) {
  const std::lock_guard lock(mutex_);
  Means& means = means_[threads];
  mix(1000 * measured.preparation_ms / static_cast<double>(pixels), means.preparation_us_per_pixel);
  mix(measured.round_share, means.shares.round_share);
  mix(measured.final_share, means.shares.final_share);
}

}  // namespace bpa
