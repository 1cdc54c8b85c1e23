// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/detect/search.hpp"
#include "core/model/library.hpp"
#include "core/pipeline/search_plan.hpp"
#include "core/result/interpretation.hpp"
#include "core/score/score_layer.hpp"

namespace bpa {

/// Intermediate results of the detection in one frame, for training, experiments and pictures.
struct FrameTrace {
  SceneFeatures scene;
  Models models;                              ///< Searched for.
  std::vector<detect::ObjectTrace> objects;   ///< One for each model.
  std::vector<detect::Candidate> candidates;  ///< Of all models.
  std::optional<SearchPlan> plan;             ///< What it ran with.
};

/// What to look for in one frame.
struct DetectRequest {
  std::vector<std::string> models = {};  ///< Names; empty means every model of the library.
  std::vector<PosePrior> priors = {};    ///< What is known beforehand, in the camera frame.
  /// What an earlier frame of the same view showed: aligned and scored first, as any other
  /// placement. Where it is certain again, its surface is not searched, and a standing scene takes
  /// a fraction of the time. Models that are not searched are ignored.
  std::vector<ExpectedPlacement> expected = {};
  int top_k = kDefaultTopK;  ///< Number of interpretations to return, 1 to 100.
  /// Time for the frame, milliseconds; 0: no limit. The less time, the smaller the part of the
  /// scene that is searched, for all models alike; where it is short beside a whole
  /// preparation, the frame is prepared in less detail (search_plan.hpp). Preparation is not cut.
  /// Returns the best found by then. With a budget, the answer depends on the machine's speed.
  double budget_ms = 0;
  std::uint64_t seed = 0;  ///< Same frame, library, options and seed: same answer.
  int num_threads = 0;     ///< 0 = one per core. Does not change the answer.
  /// Called after each round of the search with what is found so far, on the calling thread, for
  /// those who cannot wait. It lacks the final stages: poses that a view leaves open are not
  /// compared. Does not change the answer.
  std::function<void(const SceneInterpretations&)> on_round = {};
};

/// Checks all that no library is needed for; the message names the field, its value and the rule.
Status validate(const DetectRequest& request);

/// What a search found in a frame. Scene interpretations choose from it.
struct SearchResult {
  detect::Candidates candidates = {};          ///< Of all models.
  std::vector<MissedModel> missed = {};        ///< Of each model, as SceneInterpretations has it.
  std::vector<std::string> not_searched = {};  ///< Names of models that were lost with their hosts.
  SearchEffort effort = {};
  bool cut = false;           ///< Time ran out.
  double preparation_ms = 0;  ///< What preparing the frame took.
};

/// Waits for what other hosts find. `pixels`: size of the reduced image of the scene.
using RemoteResult = std::function<Result<SearchResult>(std::size_t pixels)>;
/// Lets other hosts search a frame for these models, and returns at once. Called before the frame
/// is prepared here: they prepare it meanwhile. Where it fails, so does the detection.
using RemoteSearch = std::function<Result<RemoteResult>(const Models&)>;
/// The same for each of several frames.
using RemoteSearches = std::function<RemoteSearch(const Frame&, const DetectRequest&)>;

/// Finds the objects of a library in RGB-D frames. Immutable after construction; detect() may be
/// called from several threads at once.
class Detector {
 public:
  Detector(std::shared_ptr<const ModelLibrary> library, DetectorOptions options,
           score::ScoreLayers layers = score::default_score_layers());

  /// Ranked interpretations of the frame. Fails with invalid_argument on a frame, request or
  /// library that breaks a rule (an empty library too). Fails with not_found on a model, also of a
  /// prior, that the library does not hold. An empty scene is a result, not an error. `trace`, if
  /// given, receives the candidates of each stage. With `elsewhere`, other hosts search: `trace`
  /// lacks the stages of objects, and `on_round` is not called.
  Result<SceneInterpretations> detect(const Frame& frame, const DetectRequest& request = {},
                                      FrameTrace* trace = nullptr,
                                      const RemoteSearch& elsewhere = {}) const;
  /// The part of detect() before the interpretation, for a host that searches for another one.
  /// Fails as detect() does.
  Result<SearchResult> search(const Frame& frame, const DetectRequest& request) const;

  const ModelLibrary& library() const { return *library_; }
  const DetectorOptions& options() const { return options_; }
  const score::ScoreLayers& score_layers() const { return layers_; }

 private:
  struct Job;

  SearchFacts facts_of(const Frame& frame, const DetectRequest& request,
                       const Models& models) const;
  Result<Job> begin(const Frame& frame, const DetectRequest& request) const;
  SearchResult search_here(const Job& job, FrameTrace* trace) const;
  SceneInterpretations interpreted(const Job& job, SearchResult& found) const;

  std::shared_ptr<const ModelLibrary> library_;
  DetectorOptions options_;
  score::ScoreLayers layers_;
  std::shared_ptr<CostMeter> costs_;  ///< Of searches with a budget.
};

/// The file of a library's own score layers: "FOLDER/score_layer.json".
std::string score_layer_path(const std::string& library_folder);

Status write_score_layers(const std::string& path, const score::ScoreLayers& layers);
/// Fails with not_found, or as score_layers_from_json().
Result<score::ScoreLayers> read_score_layers(const std::string& path);
/// The layers of the library, or default_score_layers() where the library has none of its own.
Result<score::ScoreLayers> library_score_layers(const std::string& library_folder);

}  // namespace bpa
