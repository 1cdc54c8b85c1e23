// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/pipeline/detector_options.hpp"

// How a time budget is kept: what is searched follows from the time there is. No function looks at
// a clock.

namespace bpa {

/// Lets the preparation of a frame do less where `budget_ms` > 0 is small: below 200 ms fewer
/// keypoints, no outlines and no flat regions; below 140 ms an image of at most 240 pixels a row
/// too, and below 70 ms of 160. With one of `num_threads` (1 or more) so from 1.8 times the budget.
/// Returns about which share of the whole preparation's time is left, (0, 1].
double shorten_preparation(double budget_ms, int num_threads, DetectorOptions& options);

/// Whether the rest of the preparation leaves time for a search: on a slow or busy machine outlines
/// and flat regions may not. `surface_ms`: what the surface took.
bool details_fit(double surface_ms, double milliseconds_left);

/// Where colours tell nothing, more pairs of each reference point vote, more of its poses are
/// tried, and more candidates go on.
void search_without_colors(DetectorOptions& options);

/// The more models (1 or more) are searched for, the less is looked at for those without a sign
/// (RoundOptions::step_without_sign), unless that is set, and the more candidates of all models
/// together go on (max_in_library). Up to 24 models: as the options say; up to 119
/// all models look at whole samples.
void share_among_models(int models, DetectorOptions& options);

/// No outlines and flat regions.
void leave_out_details(SceneFeatureOptions& options);

/// `options` for a round that looks at `share` (0 to 1) of what a whole round looks at: reference
/// points, keypoints, and the candidates of all models that go on. Each is at least one.
DetectorOptions sized_round(const DetectorOptions& options, double share);

/// Lets a round go on with fewer candidates: what is nearly hopeless takes time that a budget does
/// not have.
void raise_limits(DetectOptions& options);

/// `options` for final stages that try `share` (0 to 1) of what they would, at least one of each.
DetectOptions sized_final(const DetectOptions& options, double share);

/// How much of the search fits in a time: the work of a round grows with its share, and with the
/// number of models.
class SearchPace {
 public:
  /// A first guess, from the time that the whole preparation of this frame takes on this machine.
  SearchPace(double preparation_ms, int models);

  /// The share of a whole round that fits, at most 1; 0 where that is too small for a round.
  double share_of_round(double milliseconds) const;
  /// The share of the final stages that fits, at most 1.
  double share_of_final(double milliseconds) const;
  /// A round of that share took so long: later guesses are made from this.
  void took(double share, double milliseconds);

 private:
  double round_ms_;  // of a whole round for all models
};

/// The smallest share of a whole round: with less, most objects have no reference point. Chosen by
/// hand.
constexpr double kSmallestRound = 0.06;

}  // namespace bpa
