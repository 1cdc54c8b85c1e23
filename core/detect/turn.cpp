// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/model/model_index.hpp"

namespace bpa::detect {
namespace {

constexpr int kTurnsOfOne = 6;  // near-symmetric poses that are aligned, for each that is turned

// The best candidates in near-symmetric poses, each with its quick score.
Candidates near_symmetric(const Search& search, Candidates& candidates) {
  const TurnOptions& options = search.plan.turn;
  const auto most = std::min<std::size_t>(candidates.size(), options.max_turned);
  Candidates out;
  for (std::size_t i = 0; i < most; ++i) {
    candidates[i].lowest.note(score::Limit::turned, candidates[i].score);
    if (candidates[i].score <= search.plan.limits[score::Limit::turned]) break;
    for (const Pose& motion : search.model.index->near_symmetries) {
      const Pose turned = candidates[i].pose() * motion;
      out.push_back({.model = &search.model,
                     .refinement = {.frame_from_object = turned},
                     .found_by = candidates[i].found_by,
                     .is_protected = candidates[i].is_protected,
                     .lowest = candidates[i].lowest});
    }
  }
  change_each(search, out, [&](Candidate& candidate) {
    candidate.score = search.quick_score(candidate.pose());
  });
  return out;
}

}  // namespace

Candidates turn(const Search& search, Candidates climbed) {
  sort_by_score(climbed);
  Candidates turned = near_symmetric(search, climbed);
  reject_below(search, score::Limit::aligned, turned);
  suppress_duplicates(search, turned);
  std::erase_if(turned, [&](const Candidate& t) {
    const bool known = std::ranges::any_of(
        climbed, [&](const Candidate& c) { return duplicates(search, t.pose(), c.pose()); });
    if (known) search.reject("there already", t.pose());
    return known;
  });
  keep_first(search, kTurnsOfOne * search.plan.turn.max_turned, turned);
  change_each(search, turned, [&](Candidate& candidate) {
    candidate = search.scored(candidate, search.refine(candidate.pose(), kLastAlignment));
  });
  std::ranges::move(turned, std::back_inserter(climbed));
  return climbed;
}

}  // namespace bpa::detect
