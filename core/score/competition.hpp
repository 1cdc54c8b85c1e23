// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace bpa {

/// Which placements of a frame exclude one another: at most one of those that claim the same place
/// or the same observed points can be right.
struct Competition {
  struct Rival {
    std::uint32_t other = 0;
    /// The chance that this one is right if the other's pose is nearly the true one: 1 when both
    /// are the same pose of the same model, a half at 2.5 cm or π/16, 0 for others.
    double same_pose = 0;
  };
  std::vector<std::vector<Rival>> rivals;  ///< Of each placement; not itself.
};

/// The probability that each placement is right, given that its rivals compete with it and that
/// none of them may be right: the sum of exp(score) over itself and its rivals, each times
/// same_pose, divided by 1 plus the same sum of all in full. `scores` are log odds against nothing.
std::vector<double> competing_probabilities(std::span<const double> scores,
                                            const Competition& competition);

}  // namespace bpa
