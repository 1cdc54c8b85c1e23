// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>

#include "core/detect/options.hpp"
#include "core/score/limits.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::detect {

/// Why an entry of a plan has its value, by the entry's name.
using PlanReasons = std::map<std::string, std::string>;

/// What the search for one model depends on, besides options.
struct DetectFacts {
  int models = 1;       ///< That are searched for, 1 or more.
  bool colored = true;  ///< Hypotheses of all models are compared by colour.
};

/// The numbers that the stages run with. A setting of 0 that means "as planned" is replaced by the
/// number; any other setting is as the user gave it.
struct DetectPlan : DetectOptions {
  /// `reasons`, if given, receives why each planned entry has its value. The limits of `layers`
  /// must hold ScoreOptions::keep_right (LearnedLimits::at()).
  DetectPlan(const DetectOptions& options = {},
             const score::ScoreLayers& layers = score::default_score_layers(),
             const DetectFacts& facts = {}, PlanReasons* reasons = nullptr);

  score::Limits limits;  ///< Of the stages.
  /// Limits::components for placements without and with colours.
  std::array<score::Limits, 2> limits_by_color;
};

/// The plan of a round that examines `share`, (0, 1], of what a whole round examines, at least one
/// candidate at each stage.
DetectPlan round_plan(const DetectPlan& whole, double share);

/// The plan of final stages that try `share`, (0, 1], of what they would, at least one of each.
DetectPlan final_plan(const DetectPlan& whole, double share);

/// So much of a count, at least 1; 0 stays.
int part_of(int count, double share);

}  // namespace bpa::detect
