// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <bpa/core/detect/single_object.hpp>
#include <bpa/core/scene/interpretation.hpp>

namespace bpa {

struct InterpretationOptions {
  double pixels_per_unit = 300;  ///< Explained pixels of a certain placement worth one unit.
  double object_penalty = 0.2;   ///< Units that each further object costs.
  double explained_weight = 2;   ///< Of the ratio of explained to observed pixels.
  double max_shared = 0.3;       ///< Two placements may share this part of the smaller one.
  double min_probability = 0.5;  ///< A placement less probable than this lowers the score.
  int annealing_steps = 20000;
  int max_interpretations = 100;  ///< Paper section VI: the 100 best are kept.
  std::uint64_t seed = 0;
};

/// Explains the scene by subsets of the candidates (paper section VI): simulated annealing on the
/// multi-object-placement score - single scores weighted by the part of its pixels that each
/// placement has for itself, the ratio of explained to observed pixels, and a penalty per object -
/// keeping the best distinct subsets met on the way. Ranked, best first; at least one, perhaps of
/// no objects. `observed_pixels` counts the searched pixels of the reduced image.
std::vector<Interpretation> interpret(const std::vector<Candidate>& candidates, int observed_pixels,
                                      const InterpretationOptions& options);

}  // namespace bpa
