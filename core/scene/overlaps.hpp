// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/detect/candidate.hpp"
#include "core/score/competition.hpp"

namespace bpa::scene {

/// What two placements have in common.
struct Overlap {
  std::uint32_t other = 0;
  int common = 0;            ///< Observed pixels that both explain.
  bool conflicting = false;  ///< They cannot both be there.
};
using Overlaps = std::vector<std::vector<Overlap>>;  ///< Of each candidate.

/// For each candidate of at least `competing` log odds (Limit::competing), the others of these that
/// share observed pixels or its space, by rising `other`. Two conflict where one excludes the
/// other (detect::exclude()).
Overlaps find_overlaps(const detect::Candidates& candidates, double competing);

/// The rivals of each candidate: those that it conflicts with.
score::Competition competition_of(const detect::Candidates& candidates, const Overlaps& overlaps);

/// The same, where the poses of an object count as one: rivals of the same model in the same place.
score::Competition of_objects(const detect::Candidates& candidates, score::Competition poses);

/// The other poses in which the object of candidate `chosen` explains the same view, by falling
/// weight: a mug with its handle out of sight, a box with one visible face. They are its rivals of
/// the same model; nearly equal poses are merged. Their weights and the chosen pose's own sum to 1.
/// Leaves out weights below `min_weight`. Empty if the view determines the pose.
std::vector<PoseAlternative> alternatives_of(const detect::Candidates& candidates,
                                             const score::Competition& competition,
                                             std::size_t chosen, double min_weight = 0.02);

}  // namespace bpa::scene
