// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <bpa/core/score/color_score.hpp>
#include <bpa/core/score/likelihood.hpp>

namespace bpa {
namespace {

constexpr float kExplained = 0.01f;  // metres between prediction and observation
constexpr double kColorSigma = 12;   // CIELAB
constexpr float kLightnessWeight = 0.5f;

// The sums of both sides' colours over a few pixels.
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
  return window;
}

}  // namespace

double color_score(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                   std::span<const Eigen::Vector3f> surface, const PredictedSurface& predicted) {
  if (observed.empty() || surface.empty()) return 0;
  std::vector<Eigen::Vector3f> differences;
  float lighter = 0;
  predicted.for_each([&](int u, int v, float, std::uint32_t) {
    const Window window = compare_at(image, observed, surface, predicted, u, v);
    if (window.count < 5) return;  // the rim, where neighbours shine through
    differences.push_back((window.observed - window.predicted) / static_cast<float>(window.count));
    lighter += differences.back()[0];
  });
  if (differences.empty()) return 0;
  lighter /= static_cast<float>(differences.size());
  double sum = 0;
  for (Eigen::Vector3f& difference : differences) {
    difference[0] = kLightnessWeight * (difference[0] - lighter);
    sum += truncated_log_normal(static_cast<double>(difference.norm()), kColorSigma);
  }
  return sum / static_cast<double>(differences.size());
}

}  // namespace bpa
