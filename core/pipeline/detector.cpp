// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/cloud/cielab.hpp"
#include "core/detect/single_object.hpp"
#include "core/pipeline/frame_trace.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

using Models = std::vector<std::shared_ptr<const ObjectModel>>;

Status check_request(const DetectRequest& request) {
  if (request.top_k < 1 || request.top_k > 100) {
    return invalid_argument("top_k is " + std::to_string(request.top_k) +
                            "; it must be between 1 and 100");
  }
  if (!(request.budget_ms >= 0)) {
    return invalid_argument("budget_ms is " + std::to_string(request.budget_ms) +
                            "; it must be 0 (no limit) or more");
  }
  return {};
}

Status check_priors(const ModelLibrary& library, const std::vector<PosePrior>& priors) {
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const std::string name = "priors[" + std::to_string(i) + "]";
    if (!library.find(priors[i].model)) {
      return Status(StatusCode::not_found,
                    name + ": the library holds no model named \"" + priors[i].model + "\"");
    }
    if (Status status = validate(priors[i], name); !status.ok()) return status;
  }
  return {};
}

Result<Models> chosen_models(const ModelLibrary& library, const DetectRequest& request) {
  if (library.empty()) {
    return invalid_argument("the model library is empty; add models with 'bpa model'");
  }
  if (request.models.empty()) return library.models();
  Models chosen;
  for (const std::string& name : request.models) {
    auto model = library.find(name);
    if (!model) {
      return Status(StatusCode::not_found, "the library holds no model named \"" + name + "\"");
    }
    if (std::find(chosen.begin(), chosen.end(), model) != chosen.end()) continue;  // named twice
    chosen.push_back(std::move(model));
  }
  return chosen;
}

SurfaceMapOptions surface_options(const DetectorOptions& options, int num_threads) {
  SurfaceMapOptions out;
  out.normal_radius_m = options.normal_radius_m;
  out.max_range_m = options.max_range_m;
  out.num_threads = num_threads;
  return out;
}

SingleObjectOptions object_options(const DetectorOptions& options, std::uint64_t seed) {
  SingleObjectOptions out;
  out.hypotheses.matches_per_keypoint = options.matches_per_keypoint;
  out.hypotheses.draws_per_match = options.draws_per_match;
  out.hypotheses.peaks_per_reference = options.peaks_per_reference;
  out.hypotheses.use_edges = options.use_edges;
  out.hypotheses.seed = seed;
  out.max_clusters = options.max_clusters;
  out.max_refined = options.max_refined;
  if (!options.climb) out.max_climbed = 0;
  out.use_orientation = options.use_orientation;
  out.use_segments = options.use_segments;
  out.use_edges = options.use_edges;
  out.use_round_three = options.use_round_three;
  out.seed = seed;
  return out;
}

InterpretationOptions interpretation_options(const DetectorOptions& options, std::uint64_t seed) {
  InterpretationOptions out;
  out.min_probability = options.min_probability;
  out.object_penalty = options.object_penalty;
  out.explained_weight = options.explained_weight;
  out.annealing_steps = options.annealing_steps;
  out.seed = seed;
  return out;
}

// The first `count`, their probabilities scaled to sum to 1 again.
void keep_best(std::vector<Interpretation>& interpretations, std::size_t count) {
  if (interpretations.size() <= count) return;
  interpretations.resize(count);
  double sum = 0;
  for (const Interpretation& interpretation : interpretations) sum += interpretation.probability;
  for (Interpretation& interpretation : interpretations) interpretation.probability /= sum;
}

}  // namespace

Detector::Detector(std::shared_ptr<const ModelLibrary> library, DetectorOptions options,
                   ScoreLayers layers)
    : library_(std::move(library)), options_(std::move(options)), layers_(std::move(layers)) {}

Result<SceneInterpretations> Detector::detect(const Frame& frame, const DetectRequest& request,
                                              FrameTrace* trace) const {
  if (Status status = validate(frame); !status.ok()) return status;
  if (Status status = check_request(request); !status.ok()) return status;
  const Result<Models> models = chosen_models(*library_, request);
  if (!models.ok()) return models.status();
  if (Status status = check_priors(*library_, request.priors); !status.ok()) return status;

  Stopwatch total;
  Stopwatch stage;
  SceneInterpretations out;
  out.stamp_ns = frame.stamp_ns;
  out.frame_id = frame.frame_id;
  out.fused_frames = frame.fused;
  const auto finish_stage = [&](const char* name) {
    out.timings.push_back({name, stage.lap_milliseconds()});
  };

  SurfaceMap map = surface_map(frame, surface_options(options_, request.num_threads));
  finish_stage("surface");

  std::vector<Plane> planes;
  if (options_.label_planes && frame.background.empty()) {
    PlaneOptions plane_options;
    plane_options.min_extent_m = options_.plane_min_extent_m;
    plane_options.seed = request.seed;
    planes = label_background_planes(map, plane_options);
  }
  finish_stage("planes");

  SceneFeatureOptions feature_options;
  feature_options.max_keypoints = options_.max_keypoints;
  feature_options.max_references = options_.max_references;
  feature_options.seed = request.seed;
  feature_options.num_threads = request.num_threads;
  Image<Eigen::Vector3f> rgb;
  if (options_.use_color) rgb = reduced_color(frame, map, request.num_threads);
  SceneFeatures scene = scene_features(std::move(map), std::move(planes), feature_options, rgb);
  finish_stage("features");

  // The budget is looked at between models: whoever is not begun in time is left out, and said so.
  SingleObjectOptions single = object_options(options_, request.seed);
  single.layers = layers_;
  single.priors = request.priors;
  std::vector<std::vector<Candidate>> found(models->size());
  std::vector<std::uint8_t> late(models->size(), 0);
  if (trace) trace->objects.resize(models->size());
  parallel_for(static_cast<int>(models->size()), request.num_threads, [&](int m) {
    const auto i = static_cast<std::size_t>(m);
    late[i] = request.budget_ms > 0 && total.milliseconds() > request.budget_ms;
    if (late[i]) return;
    found[i] = detect_object(scene, (*models)[i], single, trace ? &trace->objects[i] : nullptr);
  });
  out.budget_exhausted = std::find(late.begin(), late.end(), 1) != late.end();
  finish_stage("objects");

  std::vector<Candidate> candidates;
  for (auto& of_model : found) {
    std::move(of_model.begin(), of_model.end(), std::back_inserter(candidates));
  }
  const std::vector<std::vector<Overlap>> overlaps = find_overlaps(candidates, kMaxShared);
  let_compete(candidates, overlaps);
  const auto searched = static_cast<int>(
      std::count(scene.map.searched.begin(), scene.map.searched.end(), std::uint8_t{1}));
  out.interpretations =
      interpret(candidates, overlaps, searched, interpretation_options(options_, request.seed));
  keep_best(out.interpretations, static_cast<std::size_t>(request.top_k));
  finish_stage("interpretations");
  out.total_milliseconds = total.milliseconds();
  if (trace) {
    trace->scene = std::move(scene);
    trace->models = *models;
    trace->candidates = std::move(candidates);
  }
  return out;
}

}  // namespace bpa
