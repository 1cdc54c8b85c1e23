// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_score.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.hpp"
#include "core/cloud/cielab.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {
namespace {

constexpr double kColorSigma = 12;  // CIELAB
constexpr float kLightnessWeight = 0.5f;
constexpr float kMinPixels = 5;      // of 9; with fewer a window is at the rim, with a neighbour's
constexpr float kRootOfGrey = 0.6f;  // of L = 54

// light_roots() of both sides' mean colours.
struct Window {
  Eigen::Array3f observed, predicted;
};

// Observed and predicted CIELAB colours of pixels that the placement explains, and their number.
using ColorSum = Eigen::Array<float, 8, 1>;  // observed, predicted, number, nothing

// Sums of each pixel and the two `step` pixels before and after it, but for the outermost pixels.
void add_neighbors(int step, const std::vector<ColorSum>& of, std::vector<ColorSum>& sums) {
  const auto size = static_cast<int>(of.size());
  for (int i = step; i < size - step; ++i) sums[i] = of[i - step] + of[i] + of[i + step];
}

// Means over 3 x 3 pixels, where the placement explains most of them, row by row.
std::vector<Window> windows_of(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                               std::span<const Eigen::Vector3f> surface,
                               const PredictedSurface& predicted) {
  const int width = predicted.depth.width + 2, height = predicted.depth.height + 2;
  std::vector<ColorSum> pixels(static_cast<std::size_t>(width * height), ColorSum::Zero());
  const auto index = [&](int u, int v) {
    return (v - predicted.v0 + 1) * width + u - predicted.u0 + 1;
  };
  for_each_explained(image, predicted, [&](int u, int v, std::uint32_t point) {
    pixels[index(u, v)] << observed.at(u, v), surface[point], 1, 0;
  });
  std::vector<ColorSum> rows(pixels.size(), ColorSum::Zero());
  add_neighbors(1, pixels, rows);
  add_neighbors(width, rows, pixels);  // now sums of 3 x 3
  std::vector<Window> windows;
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    const ColorSum& sum = pixels[index(u, v)];
    const float count = sum[6];
    if (count < kMinPixels) return;
    windows.push_back({light_roots(sum.head<3>() / count), light_roots(sum.segment<3>(3) / count)});
  });
  return windows;
}

// The logarithm of the gain of each root from the model to the frame.
Eigen::Array3f log_gains(const std::vector<Window>& windows) {
  Eigen::Array3f gains;
  std::vector<float> values(windows.size());
  for (int c = 0; c < 3; ++c) {
    std::transform(windows.begin(), windows.end(), values.begin(),
                   [c](const Window& window) { return window.observed[c] / window.predicted[c]; });
    gains[c] = std::log(median(values));
  }
  return gains;
}

// In CIELAB, once the model is seen under the frame's light.
float distance(const Window& window, const Eigen::Array3f& gains) {
  const Eigen::Array3f& seen = window.observed;
  Eigen::Array3f expected = window.predicted * gains;
  const float lighter = 116 * (seen[1] - expected[1]);
  expected *= seen[1] / expected[1];
  const float a = 500 * (seen[0] - expected[0]), b = 200 * (seen[2] - expected[2]);
  return std::hypot(kLightnessWeight * lighter, a, b);
}

}  // namespace

ColorAgreement compare_colors(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                              std::span<const Eigen::Vector3f> surface,
                              const PredictedSurface& predicted) {
  if (observed.empty() || surface.empty()) return {};
  const std::vector<Window> windows = windows_of(image, observed, surface, predicted);
  if (windows.empty()) return {};
  const Eigen::Array3f log_gain = log_gains(windows), gains = log_gain.exp();
  double sum = 0;
  for (const Window& window : windows) {
    sum += truncated_log_normal(static_cast<double>(distance(window, gains)), kColorSigma);
  }
  const float a = 500 * kRootOfGrey * (log_gain[0] - log_gain[1]);
  const float b = 200 * kRootOfGrey * (log_gain[2] - log_gain[1]);
  return {.likelihood = sum / static_cast<double>(windows.size()),
          .tint = static_cast<double>(std::hypot(a, b)),
          .exposure = static_cast<double>(log_gain[1])};
}

}  // namespace bpa::score
