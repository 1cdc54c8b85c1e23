// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/score/competition.hpp"
#include "core/score/components.hpp"
#include "core/score/limits.hpp"
#include "core/score/search_yield.hpp"

namespace bpa::score {

/// The learned score: each score component contributes log odds by a piecewise linear function.
/// Their sum is the log odds of the placement against an empty place. README.md compares this with
/// the paper. competing_probabilities() makes probabilities of the scores of rivals.
struct ScoreLayer {
  static constexpr std::size_t kKnots = 8;
  struct Component {
    std::array<double, kKnots> place{};  ///< Rising values of the component.
    std::array<double, kKnots> value{};  ///< Log odds there; linear between, constant beyond
                                         ///< the ends. An unknown component contributes 0.
    double at(double x) const;
  };
  std::array<Component, kScoreComponents.size()> components;  ///< In the order of the table.
  double bias = 0;
  std::string provenance;  ///< The command, data and seed that made it, for people.

  double log_odds(const ScoreValues& values) const;
};

/// The components that are known up to round three, in the order of the table. Nothing where the
/// log odds of those so far, `prior` added, are below Limits::components: the placement is
/// improbable.
std::optional<ScoreValues> measure_while_probable(Evidence& evidence, const ScoreLayer& layer,
                                                  double prior, const Limits& limits);

/// The layers of a detector.
struct ScoreLayers {
  /// Orders what round two has aligned. Components of round three are not known to it.
  ScoreLayer round_two;
  /// Of all components: what probabilities come from.
  ScoreLayer round_three;
  /// For frames or models without colour; outlines count where the frame shows them.
  ScoreLayer without_color;
  /// Of the log odds that these layers give.
  LearnedLimits limits;
  LearnedYield yield;

  const ScoreLayer& last_for(const ScoreValues& values) const {
    return std::isnan(values[component("color")]) ? without_color : round_three;
  }
};

/// The layers of config/score_layers.json, which tests/accuracy/train.sh made of simulated scenes.
/// A library may have layers of its own (`bpa train`).
const ScoreLayers& default_score_layers();

/// The layers as JSON, each component by its name.
std::string to_json(const ScoreLayers& layers);

/// Fails with corrupt (naming `where` and the fault): no JSON, another version, a missing layer or
/// an unknown score component. A component that a layer lacks adds nothing to its log odds.
Result<ScoreLayers> score_layers_from_json(const std::string& text, const std::string& where);

/// The probability of log odds.
inline double probability_of(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

/// The log odds of a probability; one nearer to 0 or 1 than a millionth counts as that far.
inline double log_odds_of(double probability) {
  const double p = std::clamp(probability, 1e-6, 1 - 1e-6);
  return std::log(p / (1 - p));
}

/// The placements of one training frame.
struct ScoreFrame {
  struct Sample {
    ScoreValues values{};
    bool right = false;
  };
  std::vector<Sample> samples;
  Competition competition;
};

/// Fits the layer by penalised maximum likelihood of the samples' labels under
/// competing_probabilities() (gradient descent with adaptive steps; deterministic). Curves rise
/// where ComponentType::rises says so. Needs samples of both kinds; otherwise fails with
/// invalid_argument.
Result<ScoreLayer> train_score_layer(std::span<const ScoreFrame> frames);

/// The layer that changes `start` no more than these frames demand: the same fit, with the penalty
/// on the difference. A few frames with truth of a user's own camera suffice. Errors as above.
Result<ScoreLayer> adapt_score_layer(const ScoreLayer& start, std::span<const ScoreFrame> frames);

/// `start` with new curves of the components for which `is_new` holds; the other curves and the
/// bias stay. So the log odds are the same where these components are not known. Errors as above.
Result<ScoreLayer> extend_score_layer(const ScoreLayer& start,
                                      const std::function<bool(const ComponentType&)>& is_new,
                                      std::span<const ScoreFrame> frames);

/// The layer with its log odds scaled and shifted so that probabilities agree with frequencies on
/// these frames: Platt scaling (Platt, "Probabilistic Outputs for Support Vector Machines", 1999),
/// fitted by maximum likelihood under competing_probabilities(). Errors as above.
Result<ScoreLayer> calibrate_score_layer(const ScoreLayer& layer,
                                         std::span<const ScoreFrame> frames);

/// Calibration: how well probabilities agree with frequencies.
struct Reliability {
  struct Bin {
    int count = 0;
    double predicted = 0, right = 0;  ///< Means over the bin.
  };
  std::array<Bin, 10> bins;  ///< By probability.
  int samples = 0, right = 0;
  double expected_calibration_error = 0;  ///< Mean of |predicted - right|, weighted by count.
  double brier_score = 0;
  double log_loss = 0;  ///< Mean of -log of the probability given to what was true.
};
Reliability reliability(const ScoreLayer& layer, std::span<const ScoreFrame> frames);

}  // namespace bpa::score
