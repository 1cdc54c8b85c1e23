// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector.hpp"

#include <algorithm>
#include <optional>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/options_yaml.hpp"
#include "core/pipeline/library_search.hpp"
#include "core/pipeline/prepare_scene.hpp"
#include "core/pipeline/search_plan.hpp"
#include "core/scene/given_others.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

using Models = std::vector<std::shared_ptr<const ObjectModel>>;

Status find_priors(const ModelLibrary& library, const std::vector<PosePrior>& priors) {
  for (std::size_t i = 0; i < priors.size(); ++i) {
    if (!library.find(priors[i].model)) {
      return not_found("priors[", i, "]: the library holds no model named \"", priors[i].model,
                       "\"");
    }
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
    if (!model) return not_found("the library holds no model named \"", name, "\"");
    const bool named_twice = std::ranges::count(chosen, model) > 0;
    if (!named_twice) chosen.push_back(std::move(model));
  }
  return chosen;
}

// Whether hypotheses of all models are compared by colour.
bool compares_colors(const Frame& frame, const DetectorOptions& options, const Models& models) {
  const auto colored = [](const auto& model) { return !model->index->cielab.empty(); };
  return !frame.color.empty() && options.features.use_color && options.detect.sample.use_colors &&
         std::ranges::all_of(models, colored);
}

// Judges the candidates again, given the others of a first interpretation.
void judge_again(const SceneFeatures& scene, const scene::Overlaps& overlaps,
                 const score::ScoreLayers& layers, const SearchPlan& plan,
                 detect::Candidates& candidates) {
  const auto present = scene::first_interpretation(candidates, overlaps);
  scene::measure_given_others(scene, overlaps, present, candidates,
                              plan.detect.limits[score::Limit::competing],
                              plan.features.num_threads);
  for (detect::Candidate& candidate : candidates) {
    apply_layer(layers.last_for(candidate.values), candidate);
  }
  scene::let_compete(candidates, overlaps);
}

// Lets the candidates compete and ranks interpretations of the scene.
std::vector<Interpretation> interpret_scene(const SceneFeatures& scene,
                                            const score::ScoreLayers& layers,
                                            detect::Candidates& candidates, const SearchPlan& plan,
                                            int top_k) {
  const auto overlaps =
      scene::find_overlaps(candidates, plan.detect.limits[score::Limit::competing]);
  scene::let_compete(candidates, overlaps);
  if (plan.scene.judge_given_others && plan.detect.score.use_round_three) {
    judge_again(scene, overlaps, layers, plan, candidates);
  }
  const auto observed = static_cast<int>(std::ranges::count(scene.map.searched, 1));
  std::vector<Interpretation> ranked = interpret(candidates, overlaps, observed, plan.scene);
  scene::keep_best(ranked, top_k);
  return ranked;
}

}  // namespace

Status validate(const DetectRequest& request) {
  if (request.top_k < 1 || request.top_k > 100) {
    return invalid_argument("top_k is ", request.top_k, "; it must be between 1 and 100");
  }
  if (!(request.budget_ms >= 0)) {
    return invalid_argument("budget_ms is ", std::to_string(request.budget_ms),
                            "; it must be 0 (no limit) or more");
  }
  for (const ExpectedPlacement& expected : request.expected) {
    if (is_valid(expected.frame_from_object)) continue;
    return invalid_argument("the expected pose of ", expected.model,
                            " is not finite with a unit quaternion; it must be");
  }
  for (std::size_t i = 0; i < request.priors.size(); ++i) {
    const Status status = detect::validate(request.priors[i], concat("priors[", i, "]"));
    if (!status.ok()) return status;
  }
  return {};
}

Result<DetectorOptions> load_detector_options(const std::string& path) {
  DetectorOptions options;
  Status status = io::read_options(path, {options_of(options), "", {}});
  if (!status.ok()) return status;
  return options;
}

Detector::Detector(std::shared_ptr<const ModelLibrary> library, DetectorOptions options,
                   score::ScoreLayers layers)
    : library_(std::move(library)),
      options_(std::move(options)),
      layers_(std::move(layers)),
      costs_(std::make_shared<CostMeter>()) {}

SearchFacts Detector::facts_of(const Frame& frame, const DetectRequest& request,
                               const Models& models) const {
  const int threads = resolve_num_threads(request.num_threads);
  SearchFacts facts{.models = static_cast<int>(models.size()),
                    .image_width = frame.camera.width,
                    .colored = compares_colors(frame, options_, models),
                    .threads = threads,
                    .seed = request.seed,
                    .budget_ms = request.budget_ms};
  if (request.budget_ms > 0) facts.costs = costs_->costs(frame.depth.size(), threads);
  return facts;
}

Result<SceneInterpretations> Detector::detect(const Frame& frame, const DetectRequest& request,
                                              FrameTrace* trace) const {
  return detect_elsewhere(frame, request, {}, trace);
}

Result<SceneInterpretations> Detector::detect_elsewhere(const Frame& frame,
                                                        const DetectRequest& request,
                                                        const MakeSearches& searches,
                                                        FrameTrace* trace) const {
  if (Status status = validate(frame); !status.ok()) return status;
  if (Status status = validate(request); !status.ok()) return status;
  const Result<Models> models = chosen_models(*library_, request);
  if (!models.ok()) return models.status();
  if (Status status = find_priors(*library_, request.priors); !status.ok()) return status;

  const Deadline deadline = Deadline::after(request.budget_ms);
  const SearchFacts facts = facts_of(frame, request, *models);
  const Result<SearchPlan> planned = plan_search(options_, layers_, facts);
  if (!planned.ok()) return planned.status();
  const SearchPlan& plan = *planned;
  std::unique_ptr<ModelSearches> elsewhere;
  if (searches) {
    auto made = searches(*models, options_, facts);
    if (!made.ok()) return made.status();
    elsewhere = std::move(made).value();
  }
  const Stopwatch total;
  SceneInterpretations out;
  out.stamp_ns = frame.stamp_ns;
  out.frame_id = frame.frame_id;
  out.fused_frames = frame.fused;
  out.plan = plan.entries;
  SceneFeatures scene = prepare_scene(frame, plan, deadline, out.timings);
  const double preparation_ms = total.milliseconds() / plan.prepared_share;
  out.sensor = name_of(scene.map.sensor);

  Stopwatch stage;
  const Deadline search_end = deadline.part(plan.time.search);
  const SearchInputs inputs{scene, plan, layers_, request, *models};
  LibrarySearch search{inputs, search_end, facts.costs, preparation_ms};
  if (request.on_round) {
    search.on_round = [&, so_far = out](detect::Candidates found) mutable {
      so_far.partial = true;
      so_far.interpretations = interpret_scene(scene, layers_, found, plan, request.top_k);
      so_far.total_milliseconds = total.milliseconds();
      request.on_round(so_far);
    };
  }
  std::optional<LocalSearches> here;
  if (!elsewhere) here.emplace(inputs, trace ? &trace->objects : nullptr);
  ModelSearches& used = elsewhere ? *elsewhere : *here;
  used.prepared(scene, total.milliseconds());
  SearchOutcome found = search.run(used);
  if (Status status = used.status(); !status.ok()) return status;
  if (plan.limited) costs_->add(frame.depth.size(), facts.threads, found.measured);
  detect::Candidates& candidates = found.candidates;
  out.budget_exhausted = found.cut;
  out.effort = found.effort;
  out.not_searched = used.lost();
  for (std::size_t i = 0; i < models->size(); ++i) {
    out.missed.push_back({(*models)[i]->name, found.missed[i]});
  }
  out.timings.push_back({"objects", stage.lap_milliseconds()});

  out.interpretations = interpret_scene(scene, layers_, candidates, plan, request.top_k);
  out.timings.push_back({"interpretations", stage.lap_milliseconds()});
  out.total_milliseconds = total.milliseconds();
  if (trace) {
    trace->scene = std::move(scene);
    trace->models = *models;
    trace->plan = plan;
    trace->candidates = std::move(candidates);
  }
  return out;
}

std::string score_layer_path(const std::string& library_folder) {
  return library_folder + "/score_layer.json";
}

Status write_score_layers(const std::string& path, const score::ScoreLayers& layers) {
  return io::write_file(path, score::to_json(layers));
}

Result<score::ScoreLayers> read_score_layers(const std::string& path) {
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  return score::score_layers_from_json(*bytes, path);
}

Result<score::ScoreLayers> library_score_layers(const std::string& library_folder) {
  Result<score::ScoreLayers> layers = read_score_layers(score_layer_path(library_folder));
  if (!layers.ok() && layers.status().code == StatusCode::not_found)
    return score::default_score_layers();
  return layers;
}

}  // namespace bpa
