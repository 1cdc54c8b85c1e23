// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/exclusion.hpp"
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/score/rival_poses.hpp"

namespace bpa::detect {
namespace {

// The candidates after `best` that exclude it and are not far worse, itself included. Marks all
// that exclude it as compared.
std::vector<std::size_t> rivals_of(const Search& search, Candidates& candidates, std::size_t best,
                                   std::vector<bool>& compared) {
  std::vector<std::size_t> rivals;
  for (std::size_t i = best; i < candidates.size(); ++i) {
    const double distance = (candidates[i].place() - candidates[best].place()).norm();
    if (compared[i] || distance > tolerance::kSamePlace * search.model.diameter) continue;
    const int common = common_pixels(candidates[i].explained, candidates[best].explained);
    if (i != best && !exclude(candidates[i], candidates[best], common)) continue;
    compared[i] = true;
    const double behind = candidates[i].score - candidates[best].score;
    candidates[i].lowest.note(score::Limit::rival_behind, behind);
    candidates[i].lowest.note(score::Limit::contender_behind, behind);
    if (behind < search.plan.limits[score::Limit::rival_behind]) continue;
    rivals.push_back(i);
  }
  return rivals;
}

// Poses within the tolerance of a right one stand for one answer: what speaks for the best of them
// speaks for all.
score::RivalEvidence best_of_same_pose(const Search& search, const std::vector<Pose>& poses,
                                       const std::vector<score::RivalEvidence>& behind,
                                       std::size_t k) {
  score::RivalEvidence best = behind[k];
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!within_tolerance(poses[i], poses[k], search.model.symmetry)) continue;
    best.depth = std::max(best.depth, behind[i].depth);
    best.color = std::max(best.color, behind[i].color);
  }
  return best;
}

}  // namespace

Candidates compare(const Search& search, Candidates candidates) {
  if (!search.plan.score.use_round_three) return candidates;
  sort_by_score(candidates);
  std::vector<bool> compared(candidates.size(), false);
  for (std::size_t best = 0; best < candidates.size(); ++best) {
    if (compared[best]) continue;
    candidates[best].lowest.note(score::Limit::compared, candidates[best].score);
    if (candidates[best].score < search.plan.limits[score::Limit::compared]) continue;
    if (search.late()) break;
    const auto rivals = rivals_of(search, candidates, best, compared);
    std::vector<Pose> poses;
    std::size_t contenders = 0;  // scores fall: the first of them
    for (const std::size_t i : rivals) {
      poses.push_back(candidates[i].pose());
      contenders += candidates[i].score - candidates[best].score >=
                    search.plan.limits[score::Limit::contender_behind];
    }
    const auto behind = score::behind_best(search.scene, search.model, poses, contenders);
    for (std::size_t k = 0; k < rivals.size(); ++k) {
      Candidate& rival = candidates[rivals[k]];
      const score::RivalEvidence evidence = best_of_same_pose(search, poses, behind, k);
      rival.values[score::component("rivals")] = evidence.depth;
      if (!search.scene.cielab.empty())
        rival.values[score::component("rivals_color")] = evidence.color;
      search.apply_layer(rival);
    }
  }
  return candidates;
}

}  // namespace bpa::detect
