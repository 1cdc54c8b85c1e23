// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_score.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/median.hpp"
#include "core/cloud/cielab.hpp"
#include "core/score/likelihood.hpp"

namespace bpa {
namespace {

constexpr double kColorSigma = 12;  // CIELAB
constexpr float kLightnessWeight = 0.5f;
constexpr int kMinPixels = 5;        // of 9; with fewer a window is at the rim, with a neighbour's
constexpr float kRootOfGrey = 0.6f;  // of L = 54

// light_roots() of both sides' mean colours.
struct Window {
  Eigen::Array3f observed, predicted;
};

// Of the pixels about (u, v) that the placement explains; nothing where they are few.
std::optional<Window> compare_at(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                                 std::span<const Eigen::Vector3f> surface,
                                 const PredictedSurface& predicted, int u, int v) {
  Eigen::Vector3f seen = Eigen::Vector3f::Zero(), expected = Eigen::Vector3f::Zero();
  int count = 0;
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - 1; x <= u + 1; ++x) {
      const float z = predicted.depth_at(x, y);
      if (z <= 0 || !explains(image, x, y, z)) continue;
      seen += observed.at(x, y);
      expected += surface[predicted.point.at(x - predicted.u0, y - predicted.v0)];
      ++count;
    }
  }
  if (count < kMinPixels) return std::nullopt;
  const auto pixels = static_cast<float>(count);
  return Window{light_roots(seen / pixels), light_roots(expected / pixels)};
}

// The logarithm of the gain of each root from the model to the frame.
Eigen::Array3f log_gains(const std::vector<Window>& windows) {
  Eigen::Array3f gains;
  std::vector<float> values(windows.size());
  for (int c = 0; c < 3; ++c) {
    std::transform(windows.begin(), windows.end(), values.begin(), [c](const Window& window) {
      return std::log(window.observed[c] / window.predicted[c]);
    });
    gains[c] = median(values);
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
  std::vector<Window> windows;
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    const auto window = compare_at(image, observed, surface, predicted, u, v);
    if (window) windows.push_back(*window);
  });
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

}  // namespace bpa
