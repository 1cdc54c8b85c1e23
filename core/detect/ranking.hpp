// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "core/detect/search.hpp"

// How stages order candidates and cut their number.

namespace bpa::detect {

/// Best score first; equal scores keep their order.
void sort_by_score(Candidates& candidates);

/// True where two poses of the model are duplicates by SelectOptions, modulo its symmetry.
bool duplicates(const Search& search, const Pose& a, const Pose& b);

/// True where the candidate is a duplicate of one that an earlier round has scored low. One that
/// scored high is worth another alignment.
bool rejected_before(const Search& search, Candidate& candidate);

/// Non-maximum suppression: sorts by score and rejects duplicates of better candidates, and what
/// an earlier round has scored low.
void suppress_duplicates(const Search& search, Candidates& candidates);

/// Rejects candidates below a limit of their score, except protected ones.
void reject_below(const Search& search, score::Limit limit, Candidates& candidates);

/// Sorts by score and rejects all but the best `count`.
void keep_best(const Search& search, int count, Candidates& candidates);

/// Calls change(candidate) for each, also on threads that have nothing else to do. Leaves out what
/// was not reached before the deadline.
void change_each(const Search& search, Candidates& candidates,
                 const std::function<void(Candidate&)>& change);

/// Rejects all but the first `count`.
void keep_first(const Search& search, int count, Candidates& candidates);

}  // namespace bpa::detect
