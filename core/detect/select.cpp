// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa::detect {

Candidates select(const Search& search, Candidates compared) {
  const SelectOptions& options = search.plan.select;
  std::erase_if(compared, [&](Candidate& candidate) {
    candidate.lowest.note(score::Limit::selected, candidate.score);
    const bool low = candidate.score < search.plan.limits[score::Limit::selected];
    if (low) search.reject("low score", candidate.pose());
    return low;
  });
  suppress_duplicates(search, compared);
  keep_first(search, options.max_placements, compared);
  return compared;
}

}  // namespace bpa::detect
