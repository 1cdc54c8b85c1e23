// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
namespace {

constexpr int kRecheckPoints = 256;  // model points of the check after the correction
constexpr RefinementOptions kCorrection{2, 64, 24, tolerance::placed_m(8),
                                        tolerance::placed_m(4.8)};

}  // namespace

Candidates correct(const Search& search, Candidates checked) {
  const auto check_score = [&](const Pose& pose) {
    return search.check(pose, {kRecheckPoints}).score();
  };
  parallel_for_spare(static_cast<int>(checked.size()), [&](int i) {
    if (search.late()) return;
    Candidate& candidate = checked[i];
    const Pose corrected = search.aligned(candidate.pose(), kCorrection);
    if (check_score(corrected) <= check_score(candidate.pose())) return;
    candidate.refinement.frame_from_object = corrected;
    candidate.score = search.quick_score(corrected, kCheckRankPoints);
  });
  sort_by_score(checked);
  return checked;
}

}  // namespace bpa::detect
