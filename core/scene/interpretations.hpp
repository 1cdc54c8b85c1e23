// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <bpa/core/detect/single_object.hpp>
#include <bpa/core/scene/interpretation.hpp>

namespace bpa {

/// Two placements may share this part of what the smaller one explains.
constexpr double kMaxShared = 0.3;

struct InterpretationOptions {
  double object_penalty = 0.2;     ///< Log odds that each further object costs.
  double explained_weight = 2;     ///< Of the ratio of explained to observed pixels.
  double max_shared = kMaxShared;  ///< Two placements may share this part of the smaller one.
  double min_probability = 0.5;    ///< A placement less probable than this lowers the score.
  int annealing_steps = 20000;
  int max_interpretations = 100;  ///< Paper section VI: the 100 best are kept.
  std::uint64_t seed = 0;
};

/// Replaces the candidates' probabilities, which know nothing of one another, by those of right
/// placements among rivals (competing_probabilities).
void let_compete(std::vector<Candidate>& candidates, double max_shared);

/// Explains the scene by subsets of the candidates (paper section VI): simulated annealing on the
/// multi-object-placement score - single scores weighted by the part of its pixels that each
/// placement has for itself, the ratio of explained to observed pixels, and a penalty per object -
/// keeping the best distinct subsets met on the way. Ranked, best first; at least one, perhaps of
/// no objects. `observed_pixels` counts the searched pixels of the reduced image.
std::vector<Interpretation> interpret(const std::vector<Candidate>& candidates, int observed_pixels,
                                      const InterpretationOptions& options);

}  // namespace bpa
