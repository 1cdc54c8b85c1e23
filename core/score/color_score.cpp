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

// How far apart they are, in CIELAB as it was observed, if the whole placement is seen `gain`
// times as bright as predicted: colours as under the light that falls here.
float distance(const Window& window, float gain) {
  const float here = brightness(window.observed) / brightness(window.predicted);
  const float lighter = brightness(window.observed) - gain * brightness(window.predicted);
  const Eigen::Vector2f color = window.observed.tail<2>() - here * window.predicted.tail<2>();
  return std::hypot(kLightnessWeight * lighter, color.norm());
}

}  // namespace

double color_score(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                   std::span<const Eigen::Vector3f> surface, const PredictedSurface& predicted) {
  if (observed.empty() || surface.empty()) return kNotKnown;
  std::vector<Window> windows;
  float seen = 0, expected = 0;
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    const Window window = compare_at(image, observed, surface, predicted, u, v);
    if (window.count < 5) return;  // the rim, where neighbours shine through
    windows.push_back(window);
    seen += brightness(window.observed);
    expected += brightness(window.predicted);
  });
  if (windows.empty()) return kNotKnown;
  double sum = 0;
  for (const Window& window : windows) {
    sum +=
        truncated_log_normal(static_cast<double>(distance(window, seen / expected)), kColorSigma);
  }
  return sum / static_cast<double>(windows.size());
}

}  // namespace bpa
