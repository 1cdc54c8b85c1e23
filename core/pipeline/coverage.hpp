// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"
#include "core/score/search_yield.hpp"

namespace bpa {

/// Where a search has tried a scene's surface, and how many objects it may have missed. The surface
/// is divided into patches: cubes as large as the surface that the smallest model shows. Each model
/// counts its tries in each patch. What is undiscovered follows by Bayes' rule (Stone, Theory of
/// Optimal Search, 1975, chapter 1).
class Coverage {
 public:
  /// `spacing`: of SceneFeatures::coarse, metres.
  Coverage(const SceneFeatures& scene,
           const std::vector<std::shared_ptr<const ObjectModel>>& models,
           const score::SearchYield& yield, double spacing);

  /// The reference points `references` were looked up in the models that `left_out` does not flag.
  void add_tries(std::span<const int> references, std::span<const std::uint8_t> left_out);
  /// How probable it is that an object explains each pixel of the reduced image.
  void explain(std::span<const float> probability);

  /// The expected number of undiscovered objects in sight, of each model, where so many are
  /// expected discovered.
  std::vector<double> missed(double discovered) const;

 private:
  struct Patch {
    double points = 0, unexplained = 0;
  };

  const score::SearchYield yield_;
  std::vector<int> patch_of_;  // of each point
  std::vector<int> pixel_of_;  // of each point; -1: none
  std::vector<Patch> patches_;
  std::vector<double> visible_;       // points that each model shows
  std::vector<std::uint16_t> tries_;  // of each model, in each patch
  std::vector<double> undiscovered_;  // the probability after these tries, likewise
};

}  // namespace bpa
