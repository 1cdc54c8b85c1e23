// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/detect/single_object.hpp"
#include "core/result/interpretation.hpp"
#include "core/scene/overlaps.hpp"

namespace bpa {

/// Two placements may share this part of what the smaller one explains.
constexpr double kMaxShared = 0.3;

struct InterpretationOptions {
  double object_penalty = 0.2;   ///< Log odds that each further object costs.
  double explained_weight = 2;   ///< Of the ratio of explained to observed pixels.
  double min_probability = 0.3;  ///< A placement less probable than this lowers the score.
  int annealing_steps = 20000;
  double min_shown = 0.02;        ///< Less probable placements are in no interpretation.
  int max_different = 20;         ///< Interpretations that show something new, the best included.
  int max_interpretations = 100;  ///< Paper section VI: the 100 best are kept.
  std::uint64_t seed = 0;
};

/// Replaces the candidates' probabilities, which know nothing of one another, by those of right
/// placements among rivals (competing_probabilities).
void let_compete(std::vector<Candidate>& candidates,
                 const std::vector<std::vector<Overlap>>& overlaps);

/// Explains the scene by subsets of the candidates (paper section VI): simulated annealing on the
/// multi-object-placement score - single scores weighted by the part of its pixels that each
/// placement has for itself, the ratio of explained to observed pixels, and a penalty per object -
/// keeping the best distinct subsets met on the way. At least one, perhaps of no objects.
///
/// Ranked so that what differs comes before near-copies: first the best; then, as long as there is
/// something to show, the best of those made of the most probable placements that no earlier one
/// holds; then what is left by falling score. The probability says how likely each is among all of
/// them. `overlaps` is find_overlaps() of the candidates; `observed_pixels` counts the searched
/// pixels of the reduced image.
std::vector<Interpretation> interpret(const std::vector<Candidate>& candidates,
                                      const std::vector<std::vector<Overlap>>& overlaps,
                                      int observed_pixels, const InterpretationOptions& options);

}  // namespace bpa
