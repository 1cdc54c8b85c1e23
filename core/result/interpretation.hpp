// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/placement.hpp"
#include "core/result/plan_entry.hpp"
#include "core/result/search_effort.hpp"

namespace bpa {

/// One way to explain the frame: a set of placements (paper section VI).
struct Interpretation {
  int rank = 1;                       ///< 1 is the best.
  double score = 0;                   ///< The multi-object-placement score; larger is better.
  double probability = 0;             ///< Among the interpretations returned; they sum to 1.
  std::vector<Placement> placements;  ///< By falling probability. Empty: nothing known is there.
};

/// Interpretations that are returned unless another number is asked for.
constexpr int kDefaultTopK = 20;

/// Time that one stage of the detector took.
struct StageTiming {
  std::string stage;  ///< Its name.
  double milliseconds = 0;
};

/// How many objects of a model a search expects to have missed.
struct MissedModel {
  std::string model;    ///< The model's name.
  double expected = 0;  ///< Objects in sight that are undiscovered; 0 or more.
};

/// The result of one search.
struct SceneInterpretations {
  std::int64_t stamp_ns = 0;                    ///< Exposure time of the frame, UTC.
  std::string frame_id;                         ///< Of placements; a camera's optical frame.
  std::vector<Interpretation> interpretations;  ///< Ranked; at least one, which may be empty.
  std::vector<StageTiming> timings;             ///< In the order the stages ran.
  double total_milliseconds = 0;                ///< Of the whole search.
  bool budget_exhausted = false;  ///< True: without the time budget, more is searched.
  /// Models whose search was lost with a host that searched for them; empty on one host.
  std::vector<std::string> not_searched;
  /// Of each model that was searched for; empty from several views. With a small sum, what is not
  /// reported was searched for and not found.
  std::vector<MissedModel> missed;
  bool partial = false;         ///< The search goes on (DetectRequest::on_round).
  SearchEffort effort;          ///< The work that the search did.
  std::vector<PlanEntry> plan;  ///< What it ran with. Empty where it came over the wire.
  std::string sensor;           ///< Kind of depth camera that the frame was taken for (SensorKind).
  int fused_frames = 1;         ///< Number of frames combined into the searched depth.
};

/// A placement of an earlier frame, in the frame of the request's priors.
struct ExpectedPlacement {
  std::string model;       ///< The model's name.
  Pose frame_from_object;  ///< Metres.
};

/// The placements of the best interpretation, for the next frame.
std::vector<ExpectedPlacement> expected_after(const SceneInterpretations& result);

}  // namespace bpa
