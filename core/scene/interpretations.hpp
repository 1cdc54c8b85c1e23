// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/options.hpp"
#include "core/detect/candidate.hpp"
#include "core/result/interpretation.hpp"
#include "core/scene/overlaps.hpp"

namespace bpa::scene {

struct InterpretationOptions {
  BPA_OPTION(double, min_probability, 0.5, (0, 1),
             "Objects whose presence is less probable are not part of the best interpretation.");
  BPA_OPTION(double, min_pose_probability, 0, (0, 1),
             "Objects whose likeliest pose is less probable are left out of the best "
             "interpretation. 0.5 leaves out open poses.");
  BPA_OPTION(double, object_penalty, 0, (0, 100),
             "Log odds that each further object of an interpretation costs, beyond those of "
             "min_probability.");
  BPA_OPTION(int, annealing_steps, 20000, (0, 10000000),
             "Moves of simulated annealing (paper section VI).");
  BPA_OPTION(bool, judge_given_others, true, (),
             "Judge each placement again, given the others of a first interpretation.");
  BPA_OPTION(int, max_interpretations, 100, (1, 100),
             "Best interpretations kept (paper section VI: 100).");
  int max_different = 20;  ///< Interpretations that show something new, with the best.
  std::uint64_t seed = 0;
};

/// Replaces the probabilities of single candidates by those under competition with their rivals
/// (competing_probabilities).
void let_compete(detect::Candidates& candidates, const Overlaps& overlaps);

/// Explains the scene by subsets of the candidates (paper section VI): simulated annealing on the
/// multi-object-placement score. An object is chosen by its presence (Placement::presence), at the
/// pose of the largest weight. It adds single scores, each weighted by the share of the pixels
/// that the placement has for itself. It also adds the ratio of explained to observed pixels and a
/// penalty per object. Returns the best distinct subsets met: at least one, perhaps without
/// objects.
///
/// Ranking: first the best. Then, while new placements remain, interpretations of the most probable
/// placements that no earlier one holds. Then the rest by falling score. Probabilities are relative
/// to all returned. `overlaps` is find_overlaps() of the candidates; `observed_pixels` counts the
/// searched pixels of the reduced image.
std::vector<Interpretation> interpret(const detect::Candidates& candidates,
                                      const Overlaps& overlaps, int observed_pixels,
                                      const InterpretationOptions& options);

/// Keeps the first `count`, at least 1; their probabilities are scaled to sum to 1 again.
void keep_best(std::vector<Interpretation>& interpretations, std::size_t count);

}  // namespace bpa::scene
