// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include <bpa/core/base/stopwatch.hpp>
#include <bpa/core/detect/single_object.hpp>
#include <bpa/core/model/model_index.hpp>
#include <bpa/core/score/boundary_scores.hpp>
#include <bpa/core/score/color_score.hpp>
#include <bpa/core/score/feature_score.hpp>
#include <bpa/core/score/random_walk_score.hpp>
#include <bpa/core/score/segment_scores.hpp>

namespace bpa {
namespace {

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

// Round two (paper section V): propose an alignment, accept it if the score has improved.
Aligned round_two(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                  const SingleObjectOptions& options) {
  Aligned best{start, check_score(scene, model, start)};
  float gate = 0.030f;
  for (int step = 0; step < options.bpa_steps; ++step) {
    const Pose proposed =
        align_to_surface(scene, model, best.pose, gate, 12,
                         options.seed + static_cast<std::uint64_t>(step), options.use_orientation);
    const double score = check_score(scene, model, proposed);
    if (score > best.score) best = {proposed, score};
    gate *= 0.8f;
  }
  RefinementOptions refinement;
  refinement.iterations = 4;
  refinement.max_points = 160;
  refinement.start_gate_m = 0.025f;
  refinement.end_gate_m = 0.012f;
  const Pose refined = refine_pose(scene, model, best.pose, refinement).camera_from_object;
  if (check_score(scene, model, refined) > best.score) best.pose = refined;
  best.score = placement_score(score_placement(scene.image, model, best.pose, options.quick_points),
                               options.layer);
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

constexpr double kBeside = 0.17;  // radians

// Local hill climbing of the score (paper section V): the best of alignments from beside the start,
// then small steps along and about each axis of the
// camera through the object's origin, kept when the score rises; then smaller ones.
Pose climb(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
           const SingleObjectOptions& options) {
  const auto score = [&](const Pose& pose) {
    return placement_score(score_placement(scene.image, model, pose, options.quick_points),
                           options.layer);
  };
  Aligned best{start, score(start)};
  // From beside the start, gradients may lead elsewhere.
  RefinementOptions refinement;
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

}  // namespace

PlacementEvaluator::PlacementEvaluator(const SceneFeatures& scene,
                                       std::shared_ptr<const ObjectModel> model,
                                       const ScoreLayer& layer)
    : scene_(scene), model_(std::move(model)), layer_(layer), places_(*model_) {}

Candidate PlacementEvaluator::evaluate(Refinement refinement) const {
  Candidate candidate;
  candidate.model = model_;
  candidate.components = score_placement(scene_.image, *model_, refinement.camera_from_object);
  add_round_three(scene_, *model_, places_, refinement.camera_from_object, candidate.components);
  candidate.explained = explained_pixels(scene_.image, *model_, refinement.camera_from_object);
  candidate.refinement = std::move(refinement);
  candidate.score = placement_score(candidate.components, layer_);
  candidate.probability = placement_probability(candidate.components, layer_);
  return candidate;
}

std::vector<Candidate> detect_object(const SceneFeatures& scene,
                                     const std::shared_ptr<const ObjectModel>& model,
                                     const SingleObjectOptions& options, ObjectTrace* trace) {
  StageWriter stages(trace);
  SamplingTrace sampling;
  const std::vector<Hypothesis> sampled =
      sample_hypotheses(scene, *model, options.hypotheses, trace ? &sampling : nullptr);
  stages.finish_sampling(std::move(sampling), sampled);
  const std::vector<Hypothesis> clustered =
      cluster_hypotheses(scene, *model, sampled, options.max_clusters, stages.dropped());
  stages.finish("clusters", clustered,
                [](const Hypothesis& h) { return to_pose(h.camera_from_object); });

  std::vector<Aligned> aligned;
  for (const Hypothesis& hypothesis : clustered) {
    aligned.push_back(round_two(scene, *model, to_pose(hypothesis.camera_from_object), options));
  }
  const auto of_aligned = [](const Aligned& a) -> const Pose& { return a.pose; };
  stages.finish("round_two", aligned, of_aligned);

  remove_similar(aligned, model->symmetry, of_aligned, stages.dropped());
  keep_first(aligned, options.max_refined, of_aligned, stages.dropped());
  RefinementOptions last;
  last.iterations = 8;
  last.max_points = 500;
  last.start_gate_m = 0.015f;
  last.end_gate_m = 0.008f;
  const auto by_score = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
  const auto max_climbed = static_cast<std::size_t>(options.max_climbed);
  RefinementOptions there = last;  // no step: what is known of the pose
  there.iterations = 0;
  there.start_gate_m = there.end_gate_m;
  const PlacementEvaluator evaluator(scene, model, options.layer);
  std::vector<Candidate> candidates;
  for (const Aligned& start : aligned) {
    candidates.push_back(evaluator.evaluate(refine_pose(scene, *model, start.pose, last)));
  }
  const auto of_candidate = [](const Candidate& c) -> const Pose& { return c.pose(); };
  stages.finish("aligned", candidates, of_candidate);

  std::stable_sort(candidates.begin(), candidates.end(), by_score);
  for (std::size_t i = 0; i < std::min(candidates.size(), max_climbed); ++i) {
    const Pose climbed = climb(scene, *model, candidates[i].pose(), options);
    Candidate moved = evaluator.evaluate(refine_pose(scene, *model, climbed, there));
    if (moved.score > candidates[i].score) candidates[i] = std::move(moved);
  }
  stages.finish("climbed", candidates, of_candidate);

  std::erase_if(candidates, [&](const Candidate& c) {
    const bool low = c.score < options.min_score;
    if (low) drop(stages.dropped(), "low score", to_fast(c.pose()));
    return low;
  });
  remove_similar(candidates, model->symmetry, of_candidate, stages.dropped());
  keep_first(candidates, options.max_placements, of_candidate, stages.dropped());
  stages.finish("final", candidates, of_candidate);
  return candidates;
}

namespace {

// Depth errors of neighbouring pixels go together, so that the correspondences count for fewer.
constexpr double kCorrelatedPoints = 12;

Eigen::Matrix<double, 6, 6> pose_covariance(const Refinement& refinement) {
  Eigen::Matrix<double, 6, 6> information = refinement.information / kCorrelatedPoints;
  const double position = 1 / (0.02 * 0.02);
  const double angle = 1 / (0.5 * 0.5);
  information.diagonal().head<3>().array() += position;
  information.diagonal().tail<3>().array() += angle;
  const Eigen::Matrix<double, 6, 6> inverse = information.inverse();
  return 0.5 * (inverse + inverse.transpose());
}

// A small rotation by d about the camera's axes has the quaternion (1, d / 2), so that a Gaussian
// of covariance C in d is a Bingham with the exponent -2 v^T C^-1 v in v = d / 2.
OrientationUncertainty orientation_uncertainty(const Pose& pose,
                                               const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  OrientationUncertainty out;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = solver.eigenvectors().col(k);
    const Eigen::Quaterniond turned =
        Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()) * pose.rotation;
    out.axes.col(k) = to_wxyz(turned);
    out.concentrations[k] = -2 / solver.eigenvalues()[k];
  }
  return out;
}

}  // namespace

Placement to_placement(const Candidate& candidate) {
  Placement out;
  out.model_number = candidate.model->number;
  out.model = candidate.model->name;
  out.camera_from_object = candidate.pose();
  out.covariance = pose_covariance(candidate.refinement);
  out.orientation =
      orientation_uncertainty(out.camera_from_object, out.covariance.bottomRightCorner<3, 3>());
  out.score = candidate.score;
  out.probability = candidate.probability;
  const ScoreComponents& c = candidate.components;
  out.visible_fraction = c.visibility;
  out.components = {{"range", c.range},
                    {"normal", c.normal},
                    {"visibility", c.visibility},
                    {"edge", c.edge},
                    {"edge_visibility", c.edge_visibility},
                    {"edge_support", c.edge_support},
                    {"shape", c.shape},
                    {"free_space", c.free_space},
                    {"agreeing", c.agreeing},
                    {"explained_pixels", c.explained_pixels},
                    {"expected_pixels", c.expected_pixels},
                    {"explained_area", c.explained_area},
                    {"relative_area", c.relative_area},
                    {"unknown", c.unknown},
                    {"background", c.background},
                    {"edge_likelihood", c.edge_likelihood},
                    {"occlusion_edge", c.occlusion_edge},
                    {"random_walk", c.random_walk},
                    {"segment", c.segment},
                    {"segment_affinity", c.segment_affinity},
                    {"fpfh", c.fpfh}};
  if (!std::isnan(c.color)) out.components.push_back({"color", c.color});
  return out;
}

}  // namespace bpa
