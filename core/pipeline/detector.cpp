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

const char* why_colorless(const Frame& frame, ColorContent content) {
  if (frame.color.empty()) return "the frame has no colour image";
  if (content == ColorContent::hues) return nullptr;
  return content == ColorContent::shades ? "the colour image is grey, or of one hue"
                                         : "the colour image is of one colour";
}

// Whether hypotheses of all models are compared by colour.
bool compares_colors(const DetectorOptions& options, const Models& models) {
  const auto colored = [](const auto& model) { return !model->index->cielab.empty(); };
  return options.features.use_color && options.detect.sample.use_colors &&
         std::ranges::all_of(models, colored);
}

// Judges the candidates again, given the others of an interpretation.
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
    // Twice: the copies that the first time makes sure of count the second time.
    for (int time = 0; time < 2; ++time) judge_again(scene, overlaps, layers, plan, candidates);
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
  const ColorContent content = color_content(frame);
  const char* const colorless = why_colorless(frame, content);
  SearchFacts facts{.models = static_cast<int>(models.size()),
                    .image_width = frame.camera.width,
                    .colored = !colorless && compares_colors(options_, models),
                    .colorless = colorless,
                    .outlines = content != ColorContent::none,
                    .threads = threads,
                    .seed = request.seed,
                    .budget_ms = request.budget_ms};
  if (request.budget_ms > 0) facts.costs = costs_->costs(frame.depth.size(), threads);
  return facts;
}

/// One frame's way through the detector.
struct Detector::Job {
  const Frame& frame;
  const DetectRequest& request;
  Models models;
  SearchFacts facts;
  SearchPlan plan;
  Deadline deadline;
  Stopwatch watch = {};
  SceneFeatures scene = {};
  std::vector<StageTiming> timings = {};
  double preparation_ms = 0;

  void prepare() {
    scene = prepare_scene(frame, plan, deadline, timings);
    preparation_ms = watch.milliseconds();
  }
};

Result<Detector::Job> Detector::begin(const Frame& frame, const DetectRequest& request) const {
  if (Status status = validate(frame); !status.ok()) return status;
  if (Status status = validate(request); !status.ok()) return status;
  Result<Models> models = chosen_models(*library_, request);
  if (!models.ok()) return models.status();
  if (Status status = find_priors(*library_, request.priors); !status.ok()) return status;
  const Deadline deadline = Deadline::after(request.budget_ms);
  const SearchFacts facts = facts_of(frame, request, *models);
  Result<SearchPlan> plan = plan_search(options_, layers_, facts);
  if (!plan.ok()) return plan.status();
  return Job{frame, request, std::move(models).value(), facts, std::move(plan).value(), deadline};
}

SearchResult Detector::search_here(const Job& job, FrameTrace* trace) const {
  const SearchInputs inputs{job.scene, job.plan, layers_, job.request, job.models};
  LibrarySearch search{inputs, job.deadline.part(job.plan.time.search), job.facts.costs,
                       job.preparation_ms / job.plan.prepared_share};
  if (job.request.on_round) {
    search.on_round = [&](detect::Candidates candidates) {
      SearchResult so_far{.candidates = std::move(candidates)};
      SceneInterpretations found = interpreted(job, so_far);
      found.partial = true;
      job.request.on_round(found);
    };
  }
  LocalSearches searches(inputs, trace ? &trace->objects : nullptr);
  SearchOutcome outcome = search.run(searches);
  if (job.plan.limited) {
    costs_->add(job.frame.depth.size(), job.facts.threads, outcome.measured);
  }
  SearchResult found{.candidates = std::move(outcome.candidates),
                     .effort = outcome.effort,
                     .cut = outcome.cut,
                     .preparation_ms = job.preparation_ms};
  for (std::size_t i = 0; i < job.models.size(); ++i) {
    found.missed.push_back({job.models[i]->name, outcome.missed[i]});
  }
  return found;
}

SceneInterpretations Detector::interpreted(const Job& job, SearchResult& found) const {
  const Stopwatch watch;
  SceneInterpretations out;
  out.stamp_ns = job.frame.stamp_ns;
  out.frame_id = job.frame.frame_id;
  out.timings = job.timings;
  out.budget_exhausted = found.cut;
  out.not_searched = found.not_searched;
  out.missed = found.missed;
  out.effort = found.effort;
  out.plan = job.plan.entries;
  out.sensor = name_of(job.scene.map.sensor);
  out.fused_frames = job.frame.fused;
  out.interpretations =
      interpret_scene(job.scene, layers_, found.candidates, job.plan, job.request.top_k);
  out.timings.push_back({"interpretations", watch.milliseconds()});
  out.total_milliseconds = job.watch.milliseconds();
  return out;
}

Result<SearchResult> Detector::search(const Frame& frame, const DetectRequest& request) const {
  Result<Job> job = begin(frame, request);
  if (!job.ok()) return job.status();
  job->prepare();
  return search_here(*job, nullptr);
}

Result<SceneInterpretations> Detector::detect(const Frame& frame, const DetectRequest& request,
                                              FrameTrace* trace,
                                              const RemoteSearch& elsewhere) const {
  Result<Job> job = begin(frame, request);
  if (!job.ok()) return job.status();
  RemoteResult remote;
  if (elsewhere) {
    Result<RemoteResult> started = elsewhere(job->models);
    if (!started.ok()) return started.status();
    remote = std::move(started).value();
  }
  job->prepare();
  const Stopwatch watch;
  Result<SearchResult> found =
      remote ? remote(job->scene.image.pixels.size()) : search_here(*job, trace);
  if (!found.ok()) return found.status();
  job->timings.push_back({"objects", watch.milliseconds()});
  SceneInterpretations out = interpreted(*job, *found);
  if (trace) {
    trace->scene = std::move(job->scene);
    trace->models = std::move(job->models);
    trace->plan = std::move(job->plan);
    trace->candidates = std::move(found->candidates);
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
