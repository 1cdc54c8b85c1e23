// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa {

Candidates refine(const Search& search, Candidates aligned) {
  const RefineOptions& options = search.options.refine;
  suppress_duplicates(search, aligned);
  keep_first(search, options.max_refined, aligned);
  Candidates out;
  for (const Candidate& start : aligned) {
    if (search.late() && !out.empty()) break;
    out.push_back(search.scored(search.refine(start.pose(), options.refinement), start.found_by));
  }
  sort_by_score(out);
  return out;
}

}  // namespace bpa
