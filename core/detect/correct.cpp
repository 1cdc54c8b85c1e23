// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa {

Candidates correct(const Search& search, Candidates checked) {
  const CheckOptions& options = search.options.check;
  const auto check_score = [&](const Pose& pose) {
    return search.check(pose, {options.recheck_points}).score();
  };
  parallel_for_spare(static_cast<int>(checked.size()), [&](int i) {
    if (search.late()) return;
    Candidate& candidate = checked[i];
    const Pose corrected = search.aligned(candidate.pose(), options.correction);
    if (check_score(corrected) <= check_score(candidate.pose())) return;
    candidate.refinement.camera_from_object = corrected;
    candidate.score = search.quick_score(corrected, options.rank_points);
  });
  sort_by_score(checked);
  return checked;
}

}  // namespace bpa
