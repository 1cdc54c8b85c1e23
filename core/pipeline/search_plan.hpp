// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/detect/detect_plan.hpp"
#include "core/pipeline/costs.hpp"
#include "core/pipeline/detector_options.hpp"
#include "core/result/plan_entry.hpp"
#include "core/score/search_yield.hpp"

// What a search runs with: one value, made of options and facts. Nothing else changes a setting.

namespace bpa {

/// What a plan depends on, besides options and score layers.
struct SearchFacts {
  int models = 1;       ///< That are searched for, 1 or more.
  int image_width = 0;  ///< Of the frame, pixels; 0: not known.
  bool colored = true;  ///< Hypotheses of all models are compared by colour.
  /// Why the frame's colours are no evidence, for people; null: they are.
  const char* colorless = nullptr;
  bool outlines = true;    ///< The colour image shows light or colours that differ.
  int threads = 1;         ///< 1 or more.
  std::uint64_t seed = 0;  ///< Of the request.
  double budget_ms = 0;    ///< 0: no limit.
  Costs costs = {};        ///< What parts of a search cost here, for a budget.
};

/// Shares of the time that a budget leaves. Chosen by hand: with 0.7 and with 0.82 for the rounds,
/// two seeds find 320/758 and 341/758 objects of YCB-Video and of seeds 100 and 777 in 0.1 s, and
/// 540/758 and 541/758 in 0.5 s.
struct TimePlan {
  double search = 0.93;          ///< After preparation; the rest interprets.
  double rounds = 0.82;          ///< Of the search; the final stages have the rest.
  double first_round = 0.5;      ///< Of the rounds: its cost is a guess.
  double next_round = 0.8;       ///< Of what is left of them.
  double smallest_round = 0.06;  ///< Of a whole round: with less, most objects have no point.
};

struct SearchPlan {
  SurfaceMapOptions surface;
  PlaneOptions planes;
  SceneFeatureOptions features;  ///< Of a whole round: its numbers of points.
  RoundOptions rounds;
  detect::DetectPlan detect;  ///< Of a whole round.
  scene::InterpretationOptions scene;
  ViewsOptions views;
  score::SearchYield yield;  ///< With or without colours, as the frame is.
  TimePlan time = {};
  bool limited = false;                 ///< There is a time budget.
  double prepared_share = 1;            ///< Of the work of a whole preparation, (0, 1].
  std::vector<PlanEntry> entries = {};  ///< All of it, with reasons, for people.

  /// The settings as planned.
  DetectorOptions settings() const {
    return {surface, planes, features, rounds, detect, scene, views};
  }
};

/// Pure: the same input gives the same plan. Fails with invalid_argument where the limits of the
/// layers do not hold `score.keep_right`, and on facts of no models or of negative times.
Result<SearchPlan> plan_search(const DetectorOptions& options, const score::ScoreLayers& layers,
                               const SearchFacts& facts);

/// The points of the sample of a round that examines `share`, (0, 1], of a whole one.
SceneFeatureOptions round_sample(const SearchPlan& plan, double share);

/// Whether outlines and flat regions leave time for a search. `surface_ms`: what the surface took.
bool details_fit(double surface_ms, double milliseconds_left);

/// No outlines and flat regions.
void leave_out_details(SceneFeatureOptions& options);

/// How much of the search fits in a time: the work of a round grows with its share, and with the
/// number of models.
class SearchPace {
 public:
  /// From the time that the whole preparation of this frame takes on this machine.
  SearchPace(const Costs& costs, double preparation_ms, int models);

  /// The share of a whole round that fits, at most 1; 0 where that is less than `smallest`.
  double share_of_round(double milliseconds, double smallest) const;
  /// The share of the final stages that fits, at most 1.
  double share_of_final(double milliseconds) const;
  /// A round of that share took so long: later guesses are made from this.
  void took(double share, double milliseconds);
  /// What the preparation, the rounds, and the final stages of that share took.
  Costs measured(double final_share, double final_ms) const;

 private:
  double preparation_ms_, unit_ms_;  // the unit of shares: preparations of all models
  double round_ms_;                  // of a whole round for all models
  double final_per_round_;
  double rounds_ = 0, rounds_ms_ = 0;  // that ran
};

}  // namespace bpa
