// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/stopwatch.hpp"
#include "core/detect/candidate.hpp"
#include "core/detect/detect_plan.hpp"
#include "core/detect/pose_prior.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/observation/scene_features.hpp"
#include "core/result/search_effort.hpp"
#include "core/score/feature_score.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::detect {

// The candidates of one model after each stage, for training, experiments and pictures.

/// Poses that one stage rejected for one reason.
struct Rejected {
  std::string_view reason;
  std::vector<FastPose> poses;
};

struct TraceStage {
  std::string_view name;
  std::string_view text;        ///< What the stage does, for people.
  std::vector<FastPose> poses;  ///< The candidates after the stage.
  double milliseconds = 0;
  std::vector<Rejected> rejected;

  void reject(std::string_view reason, const FastPose& pose);
};

struct ObjectTrace {
  std::vector<TraceStage> stages;  ///< In the order of detection_stages(); of all rounds.

  /// The stage of that name; a new one unless a round before had it.
  TraceStage& stage(std::string_view name, std::string_view text);
};

/// Sets score and probability from values and prior.
void apply_layer(const score::ScoreLayer& layer, Candidate& candidate);

constexpr int kQuickPoints = 200;  ///< Surface points that round two scores a placement with.
/// The same for the ranks of poses after the check and of clusters.
constexpr int kCheckRankPoints = 24, kClusterRankPoints = 64;
/// Gradient-based alignment to the end (V.7).
constexpr RefinementOptions kLastAlignment{8, 500, 60, tolerance::placed_m(6),
                                           tolerance::placed_m(3.2)};

constexpr double kNoLimit = -std::numeric_limits<double>::infinity();  ///< Of scores.

/// The search for one model in one scene: what every stage reads. Keeps references to
/// scene, model and layers.
struct Search {
  /// Priors of other models are ignored; each must be valid.
  Search(const SceneFeatures& scene, const ObjectModel& model, const DetectPlan& plan = {},
         const score::ScoreLayers& layers = score::default_score_layers(),
         std::span<const PosePrior> priors = {}, std::uint64_t seed = 0);
  /// The same search in another view of the scene.
  Search(const SceneFeatures& scene, const Search& other);

  const SceneFeatures& scene;
  const SceneSample* sample;  ///< What this round looks up; at first that of the scene.
  const CheckImage* image;    ///< What poses are checked with; at first that of the scene.
  int round = 0;
  const Candidates* before = nullptr;  ///< What earlier rounds have scored; null in the first.
  const ObjectModel& model;
  DetectPlan plan;
  const score::ScoreLayers& layers;
  ModelPriors priors;
  const std::uint64_t seed;
  score::FeaturePlaces places;
  Deadline deadline;              ///< Stages return what they have when it has passed.
  std::uint8_t* cut = nullptr;    ///< Set to 1 when a stage stopped for that; may be null.
  TraceStage* tracing = nullptr;  ///< Of the stage that runs; null unless traced.
  mutable SearchEffort effort;    ///< Counts so far; see add_effort().

  /// Whether the deadline has passed; says so in `cut`. Any thread may call it.
  bool late() const;
  /// Adds to one of the counts of `effort`. Any thread may call it.
  void add_effort(std::int64_t SearchEffort::*what, std::int64_t more = 1) const;
  /// Gradient-based alignment, with edges unless AlignOptions leaves them out.
  Refinement refine(const Pose& start, const RefinementOptions& refinement) const;
  /// The pose of refine() alone.
  Pose aligned(const Pose& start, const RefinementOptions& refinement) const;
  /// What is known of a pose that stays as it is.
  Refinement measured(const Pose& pose) const;
  /// Log odds of round two, from kQuickPoints or so many surface points, with the
  /// caller's priors and color_evidence(). Below `least`, any value below `least`: colours are not
  /// compared where even agreeing ones would not be enough.
  double quick_score(const Pose& pose) const;
  double quick_score(const Pose& pose, int points, double least = kNoLimit) const;
  /// Log odds by check_colors().
  double color_evidence(const Pose& pose) const;
  /// `candidate` at another refinement, scored with all components. `predicted` is of its pose,
  /// where that is known. The score is minus infinity where measure_while_probable() stops.
  Candidate scored(const Candidate& candidate, Refinement refinement,
                   std::optional<score::PredictedSurface> predicted = {}) const;
  /// Sets score and probability by the last layer, or by that of round two without round three.
  void apply_layer(Candidate& candidate) const;
  /// Compares `count` of the model's points at a pose with the depth image; without a tolerance,
  /// with that of CheckOptions, whose depth follows the model's size.
  score::PoseCheck check(const Pose& pose, const score::CheckCount& count,
                         const score::CheckTolerance& tolerance) const;
  score::PoseCheck check(const Pose& pose, const score::CheckCount& count) const;
  /// Notes a rejected pose in the trace.
  void reject(std::string_view reason, const Pose& pose) const;

 private:
  // Counts an alignment; returns it without edges where AlignOptions leaves them out.
  RefinementOptions begin_alignment(RefinementOptions refinement) const;
};

}  // namespace bpa::detect
