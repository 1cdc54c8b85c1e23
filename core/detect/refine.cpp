// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/score/texture_score.hpp"

namespace bpa {
namespace {

Pose turned_to_pattern(const Search& search, const Pose& pose) {
  if (!search.options.score.use_round_three) return pose;
  const SceneFeatures& scene = search.scene;
  return turn_to_pattern(scene.image, scene.log_light, search.model, pose);
}

}  // namespace

Candidates refine(const Search& search, Candidates aligned) {
  const RefineOptions& options = search.options.refine;
  reject_below(search, options.min_aligned_score, aligned);
  keep_first(search, options.max_refined, aligned);
  change_each(search, aligned, [&](Candidate& candidate) {
    candidate.refinement = {search.aligned(candidate.pose(), options.refinement)};
    candidate.score = search.quick_score(candidate.pose());
  });
  reject_below(search, options.min_refined_score, aligned);
  suppress_duplicates(search, aligned);
  return aligned;
}

Candidates score(const Search& search, Candidates refined) {
  change_each(search, refined, [&](Candidate& candidate) {
    const Pose pose = turned_to_pattern(search, candidate.pose());
    candidate = search.scored(search.measured(pose), candidate.found_by);
  });
  sort_by_score(refined);
  return refined;
}

}  // namespace bpa
