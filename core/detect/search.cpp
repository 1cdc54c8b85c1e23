// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/search.hpp"

#include <algorithm>
#include <atomic>

#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"
#include "core/score/color_check.hpp"

namespace bpa::detect {
namespace {

constexpr double kColorPoints = 2;  // independent points that colours count as in quick scores
// The depth tolerance of checks, by the model's diameter.
constexpr double kDepthShare = 0.05, kMinDepth_m = tolerance::placed_m(2.4),
                 kMaxDepth_m = tolerance::placed_m(6);
constexpr double kNormalCosine = 0.7;  // of the normals of model and surface

}  // namespace

Search::Search(const SceneFeatures& s, const ObjectModel& m, const DetectPlan& p,
               const score::ScoreLayers& l, std::span<const PosePrior> known,
               std::uint64_t random_seed)
    : scene(s),
      sample(&s.sample),
      image(&s.image),
      model(m),
      plan(p),
      layers(l),
      priors(known, m),
      seed(random_seed),
      places(m) {}

Search::Search(const SceneFeatures& s, const Search& other)
    : scene(s),
      sample(&s.sample),
      image(&s.image),
      round(other.round),
      model(other.model),
      plan(other.plan),
      layers(other.layers),
      priors(other.priors),
      seed(other.seed),
      places(other.places),
      deadline(other.deadline),
      cut(other.cut),
      tracing(other.tracing) {}

bool Search::late() const {
  const bool passed = deadline.passed();
  if (passed && cut) std::atomic_ref(*cut).store(1, std::memory_order_relaxed);
  return passed;
}

void Search::add_effort(std::int64_t SearchEffort::*what, std::int64_t more) const {
  std::atomic_ref(effort.*what).fetch_add(more, std::memory_order_relaxed);
}

RefinementOptions Search::begin_alignment(RefinementOptions refinement) const {
  if (!plan.align.use_edges) refinement.max_edges = 0;
  add_effort(&SearchEffort::alignments, refinement.iterations > 0);
  return refinement;
}

Refinement Search::refine(const Pose& start, const RefinementOptions& refinement) const {
  return refine_pose(scene, model, start, begin_alignment(refinement));
}

Pose Search::aligned(const Pose& start, const RefinementOptions& refinement) const {
  return aligned_pose(scene, model, start, begin_alignment(refinement));
}

Refinement Search::measured(const Pose& pose) const {
  RefinementOptions still = kLastAlignment;
  still.iterations = 0;
  still.start_gate_m = still.end_gate_m;
  return refine(pose, still);
}

double Search::quick_score(const Pose& pose) const { return quick_score(pose, kQuickPoints); }

double Search::color_evidence(const Pose& pose) const {
  return kColorPoints *
         score::check_colors(*image, scene.match_colors, *model.index, to_fast(pose)).log_odds();
}

double Search::quick_score(const Pose& pose, int points, double least) const {
  add_effort(&SearchEffort::quick_scores);
  score::Evidence evidence(scene, places, pose, points);
  const double without_color =
      layers.round_two.log_odds(measure(evidence, score::Round::two)) + priors.evidence(pose);
  const double most = without_color + kColorPoints * score::ColorCheck::kAgrees;
  return most < least ? without_color : without_color + color_evidence(pose);
}

Candidate Search::scored(const Candidate& candidate, Refinement refinement,
                         std::optional<score::PredictedSurface> predicted) const {
  add_effort(&SearchEffort::full_scores);
  Candidate out{.model = &model,
                .refinement = refinement,
                .found_by = candidate.found_by,
                .is_protected = candidate.is_protected,
                .lowest = candidate.lowest};
  score::Evidence evidence(scene, places, out.pose(), 0, std::move(predicted));
  out.prior = priors.evidence(out.pose());
  if (!plan.score.use_round_three) {
    out.values = measure(evidence, score::Round::two);
  } else if (!plan.score.stop_early) {
    out.values = measure(evidence, score::Round::three);
  } else {
    const bool colored = !scene.cielab.empty() && !model.index->cielab.empty();
    const auto values =
        score::measure_while_probable(evidence, colored ? layers.round_three : layers.without_color,
                                      out.prior, plan.limits_by_color[colored]);
    if (!values) {
      out.score = kNoLimit;
      return out;
    }
    out.values = *values;
  }
  out.explained = evidence.take_explained();
  apply_layer(out);
  return out;
}

void apply_layer(const score::ScoreLayer& layer, Candidate& candidate) {
  candidate.score = layer.log_odds(candidate.values) + candidate.prior;
  candidate.probability = score::probability_of(candidate.score);
}

void Search::apply_layer(Candidate& candidate) const {
  bpa::detect::apply_layer(
      plan.score.use_round_three ? layers.last_for(candidate.values) : layers.round_two, candidate);
}

void Search::reject(std::string_view reason, const Pose& pose) const {
  if (tracing) tracing->reject(reason, to_fast(pose));
}

score::PoseCheck Search::check(const Pose& pose, const score::CheckCount& count,
                               const score::CheckTolerance& tolerance) const {
  add_effort(&SearchEffort::pose_checks);
  return score::check_pose(*image, model.index->check, to_fast(pose), count, tolerance);
}

score::PoseCheck Search::check(const Pose& pose, const score::CheckCount& count) const {
  const double depth = std::clamp(kDepthShare * model.diameter, kMinDepth_m, kMaxDepth_m);
  return check(pose, count, {depth, plan.check.free_depth_m, kNormalCosine});
}

}  // namespace bpa::detect
