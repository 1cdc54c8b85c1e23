// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/image.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/model_index.hpp"
#include "core/observation/check_image.hpp"

namespace bpa::score {

/// Counts over model points on searched surface.
struct ColorCheck {
  /// Log odds of a point that agrees and of one that does not: log(0.95 / 0.44) and
  /// log(0.05 / 0.56), see colors_agree().
  static constexpr double kAgrees = 0.77, kDisagrees = -2.42;

  int seen = 0;
  int agreeing = 0;  ///< Of the same colour, by colors_agree().

  /// Log odds of the object against another one with its surface there, of one such point. 0 where
  /// fewer than six points are seen.
  double log_odds() const;
};

/// Compares ModelIndex::check_colors of the first 20 points on searched surface. `colors` has the
/// size of `image`. Counts nothing without the model's or the frame's colours.
ColorCheck check_colors(const CheckImage& image, const Image<MatchColor>& colors,
                        const ModelIndex& model, const FastPose& pose);

}  // namespace bpa::score
