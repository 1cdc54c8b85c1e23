// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/detect/candidate.hpp"
#include "core/observation/scene_features.hpp"
#include "core/scene/overlaps.hpp"

// What hides what: each placement is judged again given the others of a first interpretation. What
// they hide is neither for nor against it, and what they explain is not left over.

namespace bpa::scene {

/// The probability of each candidate that an interpretation holds; 0 for the others.
using Present = std::vector<double>;

/// By falling probability, the candidates over 0.5 that conflict with none before.
Present first_interpretation(const detect::Candidates& candidates, const Overlaps& overlaps);

/// Measures the components of Round::others for each candidate of at least `competing` log odds.
/// The others are the `present` candidates that it does not conflict with.
void measure_given_others(const SceneFeatures& scene, const Overlaps& overlaps,
                          const Present& present, detect::Candidates& candidates, double competing,
                          int num_threads);

}  // namespace bpa::scene
