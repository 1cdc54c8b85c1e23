// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/rival_poses.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/score/figure_ground.hpp"
#include "core/score/texture_score.hpp"

namespace bpa::score {
namespace {

constexpr float kSeen = 0.7f;          // of the pixels that a right pose covers
constexpr float kSeenThrough = 0.02f;  // of them: holes in the data, models that are too large
// What hides a part hides it whole: its pixels are no evidence each, or a pose that puts a handle
// behind something would seem less likely than one that puts it behind the object itself.
constexpr float kHidden = 0.9f;
constexpr float kBroad = 1.0f;  // per metre: of what a pose says nothing about

// Pixels by which two good alignments may place the same rim differently.
int beside_px(const CheckImage& image, float depth) {
  const float pixels = tolerance::kBesideRim * image.fx / depth;
  return std::clamp(static_cast<int>(std::lround(pixels)), 1, 3);
}

// True where the prediction has surface of about this depth at a pixel or beside it.
bool agrees(const PredictedSurface& other, int u, int v, float depth, int beside) {
  const auto near = [&](int du, int dv) {
    const float there = other.depth_at(u + du, v + dv);
    return there > 0 && std::abs(there - depth) < tolerance::kSameDepth;
  };
  if (near(0, 0)) return true;
  for (int dv = -beside; dv <= beside; ++dv) {
    for (int du = -beside; du <= beside; ++du) {
      if (near(du, dv)) return true;
    }
  }
  return false;
}

// The share of the pixel that shows the predicted surface: beside its rim it may show what is
// behind.
float inside(const PredictedSurface& predicted, int u, int v) {
  constexpr int kBeside[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  int covered = 0;
  for (const auto& step : kBeside) covered += predicted.depth_at(u + step[0], v + step[1]) > 0;
  return covered == 4 ? 0.95f : 0.5f;
}

// log p(observed depth | predicted), relative to that of a pixel that is not covered.
float log_likelihood(const SensorNoise& sensor, const PredictedSurface& predicted, int u, int v,
                     float observed) {
  const float depth = predicted.depth_at(u, v);
  if (!(depth > 0)) return 0;
  const float sigma = 1.5f * tolerance::depth_sigma(sensor(depth), tolerance::kRivalSigma);
  const float z = (observed - depth) / sigma;
  constexpr float kRootTwoPi = 2.5066283f;
  const float on_surface = kSeen * std::exp(-0.5f * z * z) / (kRootTwoPi * sigma);
  const float off_surface = (observed < depth ? kHidden : kSeenThrough) * kBroad;
  const float share = inside(predicted, u, v);
  return std::log(share * (on_surface + off_surface) / kBroad + 1 - share);
}

// Over the pixels of `first` where `second` disagrees.
void for_each_difference(const CheckImage& image, const PredictedSurface& first,
                         const PredictedSurface& second, const auto& visit) {
  first.for_each([&](int u, int v, float depth, std::uint32_t) {
    if (!agrees(second, u, v, depth, beside_px(image, depth))) visit(u, v);
  });
}

}  // namespace

Pixels disagreement(const CheckImage& image, const PredictedSurface& first,
                    const PredictedSurface& second) {
  Pixels pixels;
  for_each_difference(image, first, second, [&](int u, int v) { pixels.emplace_back(u, v); });
  for_each_difference(image, second, first, [&](int u, int v) {
    const float depth = first.depth_at(u, v);
    if (depth > 0 && !agrees(second, u, v, depth, beside_px(image, depth))) return;  // added above
    pixels.emplace_back(u, v);
  });
  return pixels;
}

double depth_evidence(const CheckImage& image, const PredictedSurface& first,
                      const PredictedSurface& second, const Pixels& pixels) {
  double sum = 0;
  for (const Eigen::Vector2i& pixel : pixels) {
    const int u = pixel.x(), v = pixel.y();
    const float observed = image.depth_at(u, v);
    if (!(observed > 0)) continue;
    sum += log_likelihood(image.noise, first, u, v, observed) -
           log_likelihood(image.noise, second, u, v, observed);
  }
  return sum;
}

namespace {

// The same of colours: does the image show the object or what is around it?
double color_evidence(const FigureColors& first, const FigureColors& second, const Pixels& pixels) {
  if (!first.known() || !second.known()) return 0;
  double sum = 0;
  for (const Eigen::Vector2i& pixel : pixels) {
    const int u = pixel.x(), v = pixel.y();
    const double ratio = first.log_likelihood(u, v, second.predicted()) -
                         second.log_likelihood(u, v, first.predicted());
    if (!std::isnan(ratio)) sum += ratio;
  }
  return sum / tolerance::kCorrelatedColors;
}

}  // namespace

std::vector<RivalEvidence> behind_best(const SceneFeatures& scene, const ObjectModel& model,
                                       std::span<const Pose> poses, std::size_t contenders) {
  constexpr double kFarthest = 500;
  if (poses.empty()) return {};
  const CheckImage& image = scene.image;
  std::vector<RivalEvidence> evidence(poses.size());
  if (poses.size() > 1) {
    const PredictedSurface first = predict_whole_surface(image, model, poses.front());
    const auto texture = [&](const PredictedSurface& predicted) {
      const double total = compare_texture(image, scene.log_light, model, predicted).total;
      return std::isnan(total) ? 0 : total;
    };
    const FigureColors first_colors(image, scene.sharp_light, model, first);
    evidence.front().color = texture(first);
    parallel_for_spare(static_cast<int>(poses.size()) - 1, [&](int k) {
      const PredictedSurface other = predict_whole_surface(image, model, poses[k + 1]);
      const FigureColors colors(image, scene.sharp_light, model, other);
      const Pixels pixels = disagreement(image, other, first);
      evidence[k + 1] = {depth_evidence(image, other, first, pixels),
                         texture(other) + color_evidence(colors, first_colors, pixels)};
    });
  }
  for (double RivalEvidence::*part : {&RivalEvidence::depth, &RivalEvidence::color}) {
    const double best = std::ranges::max(std::span(evidence).first(contenders), {}, part).*part;
    for (RivalEvidence& own : evidence) own.*part = std::clamp(own.*part - best, -kFarthest, 0.0);
  }
  return evidence;
}

}  // namespace bpa::score
