// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace bpa::score {

/// Which placements of a frame exclude one another: at most one of those that claim the same place
/// or the same observed points can be right.
struct Competition {
  struct Rival {
    std::uint32_t other = 0;
    /// The probability that this one is right if the other's pose is nearly the true one. 1: the
    /// same pose of the same model. A half: 2.5 cm or π/16 apart. 0: 1.5 times that, or another
    /// model.
    double same_pose = 0;
  };
  std::vector<std::vector<Rival>> rivals;  ///< Of each placement; not itself.
};

/// The probability that each placement is right, against its rivals and against none being right.
/// The numerator sums exp(score) times same_pose over itself and its rivals. The denominator is 1
/// plus the sum without same_pose. `scores` are log odds against an empty place.
std::vector<double> competing_probabilities(std::span<const double> scores,
                                            const Competition& competition);

}  // namespace bpa::score
