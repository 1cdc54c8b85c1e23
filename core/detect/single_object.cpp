// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/single_object.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/stopwatch.hpp"
#include "core/model/model_index.hpp"
#include "core/score/boundary_scores.hpp"
#include "core/score/color_score.hpp"
#include "core/score/feature_score.hpp"
#include "core/score/random_walk_score.hpp"
#include "core/score/rival_poses.hpp"
#include "core/score/segment_scores.hpp"

namespace bpa {
namespace {

constexpr std::uint64_t kPriorStream = 1ULL << 32U;  // apart from the other streams of the seed

struct Aligned {
  Pose pose;
  double score = 0;
};

CheckTolerance tight_tolerance() {
  CheckTolerance tolerance;
  tolerance.depth = 0.008f;
  tolerance.free_depth = 0.02f;
  tolerance.normal_cosine = 0.8f;
  return tolerance;
}

float check_score(const SceneFeatures& scene, const ObjectModel& model, const Pose& pose) {
  return check_pose(scene.image, model.index->check, to_fast(pose), 300, tight_tolerance()).score();
}

// With what experiments leave out left out.
RefinementOptions refinement_options(const SingleObjectOptions& options) {
  RefinementOptions out;
  if (!options.use_edges) out.max_edges = 0;
  return out;
}

// What a placement's score gains by the caller's priors.
void add_prior(const ModelPriors& priors, Candidate& candidate) {
  if (priors.empty()) return;
  candidate.prior = priors.evidence(candidate.pose());
  candidate.score += candidate.prior;
  candidate.probability = 1 / (1 + std::exp(-candidate.score));
}

// Round two (paper section V): propose an alignment, accept it if the score has improved.
Aligned round_two(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                  const SingleObjectOptions& options) {
  Aligned best{start, check_score(scene, model, start)};
  const AlignmentCues cues{options.use_orientation, options.use_segments, options.use_edges};
  float gate = 0.030f;
  for (int step = 0; step < options.bpa_steps; ++step) {
    const Pose proposed = align_to_surface(scene, model, best.pose, gate, 12,
                                           options.seed + static_cast<std::uint64_t>(step), cues);
    const double score = check_score(scene, model, proposed);
    if (score > best.score) best = {proposed, score};
    gate *= 0.8f;
  }
  RefinementOptions refinement = refinement_options(options);
  refinement.iterations = 4;
  refinement.max_points = 160;
  refinement.start_gate_m = 0.025f;
  refinement.end_gate_m = 0.012f;
  const Pose refined = refine_pose(scene, model, best.pose, refinement).camera_from_object;
  if (check_score(scene, model, refined) > best.score) best.pose = refined;
  best.score = placement_score(score_placement(scene.image, model, best.pose, kQuickPoints),
                               options.layers.round_two);
  return best;
}

bool similar(const Pose& a, const Pose& b, const SymmetryGroup& symmetry) {
  if ((a.translation - b.translation).norm() > 0.05) return false;
  const PoseError error = pose_error(a, b, symmetry);
  return error.position < 0.008 && error.angle < 0.1;
}

// Keeps the first `count`, for whatever reason they are first.
template <class Item, class PoseOf>
void keep_first(std::vector<Item>& items, int count, const PoseOf& pose_of, DroppedPoses* dropped) {
  const auto end = static_cast<std::size_t>(count);
  for (std::size_t i = end; i < items.size(); ++i) {
    drop(dropped, "better ones are enough", to_fast(pose_of(items[i])));
  }
  if (items.size() > end) items.erase(items.begin() + count, items.end());
}

// Sorts by falling score and drops whatever is nearly the same as something better.
template <class Item, class PoseOf>
void remove_similar(std::vector<Item>& items, const SymmetryGroup& symmetry, const PoseOf& pose_of,
                    DroppedPoses* dropped) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.score > b.score; });
  std::vector<Item> kept;
  for (Item& item : items) {
    const bool seen = std::any_of(kept.begin(), kept.end(), [&](const Item& other) {
      return similar(pose_of(item), pose_of(other), symmetry);
    });
    if (seen) {
      drop(dropped, "like a better one", to_fast(pose_of(item)));
    } else {
      kept.push_back(std::move(item));
    }
  }
  items = std::move(kept);
}

// Round three (paper section V).
void add_round_three(const SceneFeatures& scene, const ObjectModel& model,
                     const FeaturePlaces& places, const Pose& pose, ScoreComponents& out) {
  const CheckImage& image = scene.image;
  const Image<float>& edges = scene.edges.likelihood;
  const PredictedSurface predicted = predict_surface(image, model, pose);
  out.edge_likelihood = edge_likelihood_score(image, edges, model, pose);
  out.occlusion_edge = occlusion_edge_score(image, edges, predicted);
  out.random_walk = random_walk_score(image, edges, model, pose, predicted);
  const auto matches = match_segments(scene.segmentation, scene.map, model, pose, predicted);
  out.segment = segment_score(matches);
  out.segment_affinity = segment_affinity_score(scene.segmentation, matches);
  out.fpfh = fpfh_score(scene.surface, scene.keypoints, scene.fpfh, places, pose);
  if (!scene.cielab.empty() && !model.index->cielab.empty()) {
    out.color = color_score(image, scene.cielab, model.index->cielab, predicted);
  }
}

constexpr double kBeside = 0.17;      // radians
constexpr double kWorthTurning = -5;  // log odds

// Local hill climbing of the score (paper section V): the best of alignments from beside the start,
// then small steps along and about each axis of the camera through the object's origin, kept when
// the score rises; then smaller ones.
Pose climb(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
           const SingleObjectOptions& options) {
  const auto score = [&](const Pose& pose) {
    return placement_score(score_placement(scene.image, model, pose, kQuickPoints),
                           options.layers.round_two);
  };
  Aligned best{start, score(start)};
  // From beside the start, gradients may lead elsewhere.
  RefinementOptions refinement = refinement_options(options);
  refinement.iterations = 6;
  refinement.max_points = 200;
  refinement.start_gate_m = 0.020f;
  refinement.end_gate_m = 0.008f;
  for (int turn = 0; turn < 6; ++turn) {
    const Eigen::Vector3d about = (turn % 2 ? -1 : 1) * Eigen::Vector3d::Unit(turn / 2);
    Pose beside = start;
    beside.rotation = (rotation_from_vector(kBeside * about) * beside.rotation).normalized();
    const Pose refined = refine_pose(scene, model, beside, refinement).camera_from_object;
    const double reached = score(refined);
    if (reached > best.score) best = {refined, reached};
  }
  double step = 0.006;  // metres, at the object's rim
  for (int round = 0; round < options.climb_rounds; ++round) {
    const double angle = step / (0.5 * model.diameter);
    bool improved = false;
    for (int move = 0; move < 12; ++move) {
      const Eigen::Vector3d along = (move % 2 ? -1 : 1) * Eigen::Vector3d::Unit(move / 2 % 3);
      Pose pose = best.pose;
      if (move < 6) {
        pose.translation += step * along;
      } else {
        pose.rotation = (rotation_from_vector(angle * along) * pose.rotation).normalized();
      }
      const double climbed = score(pose);
      if (climbed > best.score) best = {pose, climbed}, improved = true;
    }
    if (!improved) step *= 0.5;
  }
  return best.pose;
}

// Writes down what a stage left alive, if anybody wants to know.
class StageWriter {
 public:
  explicit StageWriter(ObjectTrace* trace) : trace_(trace) {}

  DroppedPoses* dropped() { return trace_ ? &dropped_ : nullptr; }

  template <class Item, class PoseOf>
  void finish(const char* name, const std::vector<Item>& items, const PoseOf& pose_of) {
    if (!trace_) return;
    trace_->stages.push_back({name, {}, watch_.lap_milliseconds(), std::move(dropped_)});
    dropped_.clear();
    for (const Item& item : items) trace_->stages.back().poses.push_back(to_fast(pose_of(item)));
  }
  // Sampling and checks run together; they are two stages.
  void finish_sampling(SamplingTrace sampling, const std::vector<Hypothesis>& kept) {
    if (!trace_) return;
    const double both = watch_.lap_milliseconds();
    trace_->stages.push_back({"sampled",
                              std::move(sampling.considered),
                              std::max(0.0, both - sampling.check_milliseconds),
                              {}});
    trace_->stages.push_back(
        {"free_space", {}, sampling.check_milliseconds, std::move(sampling.dropped)});
    for (const Hypothesis& h : kept) trace_->stages.back().poses.push_back(h.camera_from_object);
  }

 private:
  ObjectTrace* trace_;
  Stopwatch watch_;
  DroppedPoses dropped_;
};

RefinementOptions last_alignment(const SingleObjectOptions& options) {
  RefinementOptions last = refinement_options(options);
  last.iterations = 8;
  last.max_points = 500;
  last.start_gate_m = 0.015f;
  last.end_gate_m = 0.008f;
  return last;
}

const Pose& of_aligned(const Aligned& aligned) { return aligned.pose; }
const Pose& of_candidate(const Candidate& candidate) { return candidate.pose(); }

// Round two of every cluster.
std::vector<Aligned> align_clusters(const SceneFeatures& scene, const ObjectModel& model,
                                    const std::vector<Hypothesis>& clusters,
                                    const ModelPriors& priors, const SingleObjectOptions& options,
                                    StageWriter& stages) {
  std::vector<Aligned> aligned;
  for (const Hypothesis& hypothesis : clusters) {
    aligned.push_back(round_two(scene, model, to_pose(hypothesis.camera_from_object), options));
    aligned.back().score += priors.evidence(aligned.back().pose);
  }
  stages.finish("round_two", aligned, of_aligned);
  return aligned;
}

// The distinct best of round two, aligned to the end and scored with all components; best first.
std::vector<Candidate> align_best(const SceneFeatures& scene, const ObjectModel& model,
                                  std::vector<Aligned> aligned, const PlacementEvaluator& evaluator,
                                  const ModelPriors& priors, const SingleObjectOptions& options,
                                  StageWriter& stages) {
  remove_similar(aligned, model.symmetry, of_aligned, stages.dropped());
  keep_first(aligned, options.max_refined, of_aligned, stages.dropped());
  std::vector<Candidate> candidates;
  for (const Aligned& start : aligned) {
    candidates.push_back(
        evaluator.evaluate(refine_pose(scene, model, start.pose, last_alignment(options))));
    add_prior(priors, candidates.back());
  }
  stages.finish("aligned", candidates, of_candidate);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  return candidates;
}

// The first of the candidates climb; each goes where it got to if that scores better.
void climb_first(const SceneFeatures& scene, const ObjectModel& model,
                 const PlacementEvaluator& evaluator, const ModelPriors& priors,
                 const SingleObjectOptions& options, std::vector<Candidate>& candidates,
                 StageWriter& stages) {
  RefinementOptions there = last_alignment(options);  // no step: what is known of the pose
  there.iterations = 0;
  there.start_gate_m = there.end_gate_m;
  const std::size_t count =
      std::min(candidates.size(), static_cast<std::size_t>(options.max_climbed));
  for (std::size_t i = 0; i < count; ++i) {
    const Pose climbed = climb(scene, model, candidates[i].pose(), options);
    Candidate moved = evaluator.evaluate(refine_pose(scene, model, climbed, there));
    add_prior(priors, moved);
    if (moved.score > candidates[i].score) candidates[i] = std::move(moved);
  }
  stages.finish("climbed", candidates, of_candidate);
}

// What the best are mistaken for most easily, and what the view may leave open: the same object
// turned by a near symmetry. Those of them that nothing stands for yet are aligned and scored.
void try_turned(const SceneFeatures& scene, const ObjectModel& model,
                const PlacementEvaluator& evaluator, const ModelPriors& priors,
                const SingleObjectOptions& options, std::vector<Candidate>& candidates,
                StageWriter& stages) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Aligned> turned;
  const std::size_t count =
      std::min(candidates.size(), static_cast<std::size_t>(options.max_turned));
  for (std::size_t i = 0; i < count && candidates[i].score > kWorthTurning; ++i) {
    for (const Pose& motion : model.index->near_symmetries) {
      const Pose pose = candidates[i].pose() * motion;
      const double score = placement_score(score_placement(scene.image, model, pose, kQuickPoints),
                                           options.layers.round_two);
      turned.push_back({pose, score + priors.evidence(pose)});
    }
  }
  remove_similar(turned, model.symmetry, of_aligned, stages.dropped());
  std::erase_if(turned, [&](const Aligned& t) {
    const bool known = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      return similar(t.pose, c.pose(), model.symmetry);
    });
    if (known) drop(stages.dropped(), "there already", to_fast(t.pose));
    return known;
  });
  keep_first(turned, options.max_kept_turned, of_aligned, stages.dropped());
  for (const Aligned& start : turned) {
    candidates.push_back(
        evaluator.evaluate(refine_pose(scene, model, start.pose, last_alignment(options))));
    add_prior(priors, candidates.back());
  }
  stages.finish("turned", candidates, of_candidate);
}

constexpr double kFarBehind = 6;  // log odds; worse placements are no rivals of the best

// The best placement at each place and what else may be there of the same object: what they
// disagree about tells which of them it is.
void compare_rivals(const SceneFeatures& scene, const ObjectModel& model,
                    const SingleObjectOptions& options, std::vector<Candidate>& candidates) {
  if (!options.use_round_three) return;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<bool> compared(candidates.size(), false);
  for (std::size_t best = 0; best < candidates.size(); ++best) {
    if (compared[best] || candidates[best].score < kWorthTurning) continue;
    std::vector<std::size_t> rivals;
    std::vector<Pose> poses;
    for (std::size_t i = best; i < candidates.size(); ++i) {
      const double distance =
          (candidates[i].pose().translation - candidates[best].pose().translation).norm();
      if (compared[i] || distance > kSamePlace * model.diameter) continue;
      compared[i] = true;
      if (candidates[i].score < candidates[best].score - kFarBehind) continue;
      rivals.push_back(i);
      poses.push_back(candidates[i].pose());
    }
    const std::vector<double> behind = behind_best(scene.image, model, poses);
    for (std::size_t k = 0; k < rivals.size(); ++k) {
      Candidate& rival = candidates[rivals[k]];
      rival.components.rivals = behind[k];
      const ScoreLayer& layer = options.layers.last_for(rival.components);
      rival.score = placement_score(rival.components, layer) + rival.prior;
      rival.probability = 1 / (1 + std::exp(-rival.score));
    }
  }
}

void keep_good(const SymmetryGroup& symmetry, const SingleObjectOptions& options,
               std::vector<Candidate>& candidates, StageWriter& stages) {
  std::erase_if(candidates, [&](const Candidate& c) {
    const bool low = c.score < options.min_score;
    if (low) drop(stages.dropped(), "low score", to_fast(c.pose()));
    return low;
  });
  remove_similar(candidates, symmetry, of_candidate, stages.dropped());
  keep_first(candidates, options.max_placements, of_candidate, stages.dropped());
  stages.finish("final", candidates, of_candidate);
}

}  // namespace

PlacementEvaluator::PlacementEvaluator(const SceneFeatures& scene,
                                       std::shared_ptr<const ObjectModel> model,
                                       const ScoreLayers& layers, bool use_round_three)
    : scene_(scene),
      model_(std::move(model)),
      layers_(layers),
      use_round_three_(use_round_three),
      places_(*model_) {}

Candidate PlacementEvaluator::evaluate(Refinement refinement) const {
  Candidate candidate;
  candidate.model = model_;
  candidate.components = score_placement(scene_.image, *model_, refinement.camera_from_object);
  if (use_round_three_) {
    add_round_three(scene_, *model_, places_, refinement.camera_from_object, candidate.components);
  }
  candidate.explained = explained_pixels(scene_.image, *model_, refinement.camera_from_object);
  candidate.refinement = std::move(refinement);
  const ScoreLayer& layer =
      use_round_three_ ? layers_.last_for(candidate.components) : layers_.round_two;
  candidate.score = placement_score(candidate.components, layer);
  candidate.probability = placement_probability(candidate.components, layer);
  return candidate;
}

std::vector<Candidate> detect_object(const SceneFeatures& scene,
                                     const std::shared_ptr<const ObjectModel>& model,
                                     const SingleObjectOptions& options, ObjectTrace* trace) {
  StageWriter stages(trace);
  const ModelPriors priors(options.priors, *model);
  HypothesisOptions hypotheses = options.hypotheses;
  RandomStream random(options.seed, kPriorStream + static_cast<std::uint64_t>(model->number));
  hypotheses.suggested = priors.draw(scene.coarse, options.draws_per_prior, random);
  SamplingTrace sampling;
  const std::vector<Hypothesis> sampled =
      sample_hypotheses(scene, *model, hypotheses, trace ? &sampling : nullptr);
  stages.finish_sampling(std::move(sampling), sampled);
  const std::vector<Hypothesis> clusters =
      cluster_hypotheses(scene, *model, sampled, options.max_clusters, stages.dropped());
  stages.finish("clusters", clusters,
                [](const Hypothesis& h) { return to_pose(h.camera_from_object); });
  const PlacementEvaluator evaluator(scene, model, options.layers, options.use_round_three);
  std::vector<Candidate> candidates =
      align_best(scene, *model, align_clusters(scene, *model, clusters, priors, options, stages),
                 evaluator, priors, options, stages);
  climb_first(scene, *model, evaluator, priors, options, candidates, stages);
  try_turned(scene, *model, evaluator, priors, options, candidates, stages);
  compare_rivals(scene, *model, options, candidates);
  keep_good(model->symmetry, options, candidates, stages);
  return candidates;
}

}  // namespace bpa
