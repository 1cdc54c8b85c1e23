// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/detect/search.hpp"

// How stages order candidates and cut their number.

namespace bpa {

/// Best score first; equal scores keep their order.
void sort_by_score(Candidates& candidates);
void sort_by_check_score(Candidates& candidates);

/// True where two poses of the model are duplicates by SelectOptions, modulo its symmetry.
bool duplicates(const Search& search, const Pose& a, const Pose& b);

/// Non-maximum suppression: sorts by score and rejects duplicates of better candidates.
void suppress_duplicates(const Search& search, Candidates& candidates);

/// Rejects all but the first `count`.
void keep_first(const Search& search, int count, Candidates& candidates);

/// The cube with an edge of 1 / `per_metre` that a position lies in.
std::uint64_t position_cell(const Eigen::Vector3f& position, float per_metre);

/// Rejects all but `count`, the best by check score less a penalty: each better candidate in the
/// same cell of 5 cm costs `rank_penalty`. So a similar object with a better fit does not crowd out
/// the true place. Sorts by check score.
void keep_best_of_places(const Search& search, int count, double rank_penalty,
                         Candidates& candidates);

}  // namespace bpa
