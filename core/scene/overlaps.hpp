// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/detect/candidate.hpp"
#include "core/score/competition.hpp"

namespace bpa {

/// What two placements have in common.
struct Overlap {
  std::uint32_t other = 0;
  int common = 0;            ///< Observed pixels that both explain.
  bool conflicting = false;  ///< They cannot both be there.
};

/// Candidates of lower log odds are ignored: they are no rivals of others.
constexpr double kHopelessScore = -8;

/// For each candidate that is not hopeless, the others that share observed pixels or their place
/// with it, by rising `other`. Two conflict when they share more than `max_shared` of what the
/// smaller one explains, when their origins are too near for two solid objects, or when more than a
/// tenth of the one's surface lies over 1 cm deep inside of the other.
std::vector<std::vector<Overlap>> find_overlaps(const std::vector<Candidate>& candidates,
                                                double max_shared);

/// The rivals of each candidate: those that it conflicts with.
Competition competition_of(const std::vector<Candidate>& candidates,
                           const std::vector<std::vector<Overlap>>& overlaps);

}  // namespace bpa
