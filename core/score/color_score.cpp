// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_score.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/score/likelihood.hpp"

namespace bpa {
namespace {

constexpr float kExplained = 0.01f;  // metres between prediction and observation
constexpr double kColorSigma = 12;   // CIELAB
constexpr float kLightnessWeight = 0.5f;
// CIELAB is linear in the cube roots of light, L + 16 and a and b alike: what half the light falls
// on has all three smaller by the same factor.
constexpr float kLightnessOfNothing = -16;

float brightness(const Eigen::Vector3f& lab) { return lab[0] - kLightnessOfNothing; }

// Both sides' colours, the mean of a few pixels.
struct Window {
  Eigen::Vector3f observed = Eigen::Vector3f::Zero();
  Eigen::Vector3f predicted = Eigen::Vector3f::Zero();
  int count = 0;
};

Window compare_at(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                  std::span<const Eigen::Vector3f> surface, const PredictedSurface& predicted,
                  int u, int v) {
  Window window;
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - 1; x <= u + 1; ++x) {
      const float z = predicted.depth_at(x, y);
      if (z <= 0) continue;
      const std::size_t i = observed.index(x, y);
      const float depth = image.pixels[i].depth;
      if (depth <= 0 || std::abs(depth - z) > kExplained) continue;
      window.observed += observed[i];
      window.predicted += surface[predicted.point.at(x - predicted.u0, y - predicted.v0)];
      ++window.count;
    }
  }
  window.observed /= static_cast<float>(std::max(1, window.count));
  window.predicted /= static_cast<float>(std::max(1, window.count));
  return window;
}

// The cube roots of X, Y and Z of a colour, each relative to white. Gains of light multiply them.
Eigen::Array3f cone_roots(const Eigen::Vector3f& lab) {
  constexpr float kDarkest = 0.1f;  // noise alone
  const float y = brightness(lab) / 116;
  return Eigen::Array3f(y + lab[1] / 500, y, y - lab[2] / 200).max(kDarkest);
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The logarithm of the gain of each cone root from the model to the frame.
Eigen::Array3f log_gains(const std::vector<Window>& windows) {
  Eigen::Array3f gains;
  std::vector<float> values(windows.size());
  for (int c = 0; c < 3; ++c) {
    std::transform(windows.begin(), windows.end(), values.begin(), [c](const Window& window) {
      return std::log(cone_roots(window.observed)[c] / cone_roots(window.predicted)[c]);
    });
    gains[c] = median(values);
  }
  return gains;
}

// In CIELAB, once the model is seen under the frame's light.
float distance(const Window& window, const Eigen::Array3f& gains) {
  const Eigen::Array3f seen = cone_roots(window.observed);
  Eigen::Array3f expected = cone_roots(window.predicted) * gains;
  const float lighter = 116 * (seen[1] - expected[1]);
  expected *= seen[1] / expected[1];
  const float a = 500 * (seen[0] - expected[0]), b = 200 * (seen[2] - expected[2]);
  return std::hypot(kLightnessWeight * lighter, a, b);
}

}  // namespace

ColorAgreement compare_colors(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                              std::span<const Eigen::Vector3f> surface,
                              const PredictedSurface& predicted) {
  constexpr float kBrightnessOfGrey = 0.6f;  // of L = 54
  if (observed.empty() || surface.empty()) return {};
  std::vector<Window> windows;
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    const Window window = compare_at(image, observed, surface, predicted, u, v);
    if (window.count >= 5)
      windows.push_back(window);  // else the rim, where neighbours shine through
  });
  if (windows.empty()) return {};
  const Eigen::Array3f log_gain = log_gains(windows), gains = log_gain.exp();
  double sum = 0;
  for (const Window& window : windows) {
    sum += truncated_log_normal(static_cast<double>(distance(window, gains)), kColorSigma);
  }
  const float a = 500 * kBrightnessOfGrey * (log_gain[0] - log_gain[1]);
  const float b = 200 * kBrightnessOfGrey * (log_gain[2] - log_gain[1]);
  return {sum / static_cast<double>(windows.size()), static_cast<double>(std::hypot(a, b))};
}

}  // namespace bpa
