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
    bool same_pose = false;  ///< The same model within 2.5 cm and π/16: right if this one is.
  };
  std::vector<std::vector<Rival>> rivals;  ///< Of each placement; not itself.
};

/// The probability that each placement is right, given that its rivals compete with it and that
/// none of them may be right: the sum of exp(score) over itself and the rivals of the same pose,
/// divided by 1 plus that sum over itself and all rivals. `scores` are log odds against nothing.
std::vector<double> competing_probabilities(std::span<const double> scores,
                                            const Competition& competition);

}  // namespace bpa
