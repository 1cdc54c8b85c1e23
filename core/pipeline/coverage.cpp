// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/model/model_index.hpp"

namespace bpa {

Coverage::Coverage(const SceneFeatures& scene,
                   const std::vector<std::shared_ptr<const ObjectModel>>& models,
                   const score::SearchYield& yield, double spacing)
    : yield_(yield) {
  for (const auto& model : models) {
    const double points = surface_area(*model) / (spacing * spacing);
    visible_.push_back(std::max(1.0, yield.visible * points));
  }
  const auto edge = static_cast<float>(spacing * std::sqrt(std::ranges::min(visible_)));
  std::map<std::array<int, 3>, int> numbers;
  for (const Eigen::Vector3f& point : scene.coarse.points) {
    const Eigen::Vector3i cube = (point / edge).array().floor().cast<int>();
    const auto next = static_cast<int>(numbers.size());
    const int patch = numbers.try_emplace({cube.x(), cube.y(), cube.z()}, next).first->second;
    patch_of_.push_back(patch);
    pixel_of_.push_back(scene.image.pixel_of(point));
    patches_.resize(numbers.size());
    patches_[patch].points += 1;
    patches_[patch].unexplained += 1;
  }
  tries_.assign(models.size() * patches_.size(), 0);
  undiscovered_.assign(tries_.size(), 1);
}

void Coverage::add_tries(std::span<const int> references, std::span<const std::uint8_t> left_out) {
  for (std::size_t m = 0; m < visible_.size(); ++m) {
    if (left_out[m]) continue;
    for (const int point : references) {
      const int patch = patch_of_[point];
      const std::size_t k = m * patches_.size() + patch;
      const double tried = visible_[m] * ++tries_[k] / patches_[patch].points;
      undiscovered_[k] = yield_.undiscovered(tried);
    }
  }
}

void Coverage::explain(std::span<const float> probability) {
  for (Patch& patch : patches_) patch.unexplained = 0;
  for (std::size_t i = 0; i < patch_of_.size(); ++i) {
    const double explained = pixel_of_[i] < 0 ? 0 : double{probability[pixel_of_[i]]};
    patches_[patch_of_[i]].unexplained += 1 - explained;
  }
}

std::vector<double> Coverage::missed(double discovered) const {
  const std::size_t patches = patches_.size();
  const double surface = std::max<double>(1, static_cast<double>(patch_of_.size()));
  const auto models = static_cast<double>(visible_.size());
  // Of one object of a model, anywhere on the surface: the probability that it is undiscovered, and
  // that it is so where nothing else is.
  double any = 0;
  std::vector<double> out(visible_.size());
  for (std::size_t m = 0; m < visible_.size(); ++m) {
    for (std::size_t p = 0; p < patches; ++p) {
      const Patch& patch = patches_[p];
      const double undiscovered = undiscovered_[m * patches + p] / surface;
      any += patch.points * undiscovered / models;
      out[m] += patch.unexplained * undiscovered;
    }
  }
  const double expected = (yield_.objects + discovered) / (yield_.scenes + 1 - any);
  for (double& of_model : out) of_model *= expected / models;
  return out;
}

}  // namespace bpa
