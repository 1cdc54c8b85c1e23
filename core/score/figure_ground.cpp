// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/figure_ground.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/median.hpp"
#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {
namespace {

// Chosen by hand on simulated piles, as all constants of this file.
constexpr std::size_t kFewestExplained = 20;  // pixels
constexpr std::size_t kMostExplained = 64;
constexpr float kFewestAround = 8;  // pixels of surroundings
constexpr int kAround = 8;          // pixels: half a window of surroundings
constexpr float kUnusual = 0.02f;   // probability density of a colour that nobody foresaw
// Standard deviations of log_light(): shading and inexact models, and of one surface in the image.
const Eigen::Array3f kModelSigma(0.25f, 0.06f, 0.10f);
const Eigen::Array3f kKernel(0.12f, 0.04f, 0.07f);

float density(const Eigen::Vector3f& difference, const Eigen::Array3f& sigma) {
  constexpr float kNormalizer = 15.75f;  // (2 pi)^1.5
  const float z = (difference.array() / sigma).square().sum();
  return std::exp(-0.5f * z) / (kNormalizer * sigma.prod());
}

}  // namespace

FigureColors::FigureColors(const CheckImage& image, const Image<Eigen::Vector3f>& colors,
                           const ObjectModel& model, const PredictedSurface& predicted)
    : image_(image), colors_(colors), model_(model), predicted_(predicted) {
  if (colors.empty()) return;
  const std::vector<Eigen::Vector3f>& own = model.index->log_light;
  std::vector<float> differences[3];
  for_each_explained(image, predicted, [&](int u, int v, std::uint32_t point) {
    const Eigen::Vector3f& color = colors.at(u, v);
    explained_.push_back(color);
    if (own.empty()) return;
    for (int c = 0; c < 3; ++c) differences[c].push_back(color[c] - own[point][c]);
  });
  known_ = explained_.size() >= kFewestExplained;
  if (!known_) return;
  if (!own.empty()) {
    for (int c = 0; c < 3; ++c) light_[c] = median(differences[c]);
  }
  const std::size_t step = (explained_.size() + kMostExplained - 1) / kMostExplained;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < explained_.size(); i += step) explained_[kept++] = explained_[i];
  explained_.resize(kept);
}

double FigureColors::log_likelihood(int u, int v, const PredictedSurface& other) const {
  const float z = predicted_.depth_at(u, v);
  const bool hidden = image_.hides(image_.depth_at(u, v), z);
  return z > 0 && !hidden ? of_object(u, v) : of_surroundings(u, v, other);
}

double FigureColors::of_object(int u, int v) const {
  const Eigen::Vector3f& seen = colors_.at(u, v);
  float sum = 0;
  for (const Eigen::Vector3f& color : explained_) sum += density(seen - color, kKernel);
  float likelihood = sum / static_cast<float>(explained_.size());
  const std::vector<Eigen::Vector3f>& own = model_.index->log_light;
  if (!own.empty()) {
    const std::uint32_t point = predicted_.point.at(u - predicted_.u0, v - predicted_.v0);
    likelihood = std::max(likelihood, density(seen - own[point] - light_, kModelSigma));
  }
  return std::log(double{likelihood + kUnusual});
}

double FigureColors::of_surroundings(int u, int v, const PredictedSurface& other) const {
  const Eigen::Vector3f& seen = colors_.at(u, v);
  float sum = 0, count = 0;
  for (int y = v - kAround; y <= v + kAround; y += 2) {
    for (int x = u - kAround; x <= u + kAround; x += 2) {
      if (!colors_.contains(x, y) || predicted_.depth_at(x, y) > 0 || other.depth_at(x, y) > 0) {
        continue;
      }
      sum += density(seen - colors_.at(x, y), kKernel);
      ++count;
    }
  }
  if (count < kFewestAround) return kNotKnown;
  return std::log(double{sum / count + kUnusual});
}

}  // namespace bpa::score
