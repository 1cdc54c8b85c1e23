// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/score/texture_score.hpp"

namespace bpa::detect {

Candidates refine(const Search& search, Candidates aligned) {
  const RefineOptions& options = search.plan.refine;
  reject_below(search, score::Limit::aligned, aligned);
  keep_first(search, options.max_refined, aligned);
  change_each(search, aligned, [&](Candidate& candidate) {
    candidate.refinement = {search.aligned(candidate.pose(), kLastAlignment)};
    candidate.score = search.quick_score(candidate.pose());
  });
  reject_below(search, score::Limit::refined, aligned);
  suppress_duplicates(search, aligned);
  return aligned;
}

Candidates score(const Search& search, Candidates refined) {
  change_each(search, refined, [&](Candidate& candidate) {
    const SceneFeatures& scene = search.scene;
    Pose pose = candidate.pose();
    std::optional<score::PredictedSurface> predicted;
    if (search.plan.score.use_round_three && !search.model.symmetry.trivial()) {
      predicted = score::predict_surface(scene.image, search.model, pose);
      const Pose turned =
          score::turn_to_pattern(scene.image, scene.log_light, search.model, pose, *predicted);
      if (pose_error(turned, pose).angle > 0) predicted.reset();
      pose = turned;
    }
    candidate = search.scored(candidate, search.measured(pose), std::move(predicted));
  });
  sort_by_score(refined);
  return refined;
}

}  // namespace bpa::detect
