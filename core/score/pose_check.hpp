// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/base/options.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/model_index.hpp"
#include "core/observation/check_image.hpp"

namespace bpa::score {

/// Counts over the model points that face the camera.
struct PoseCheck {
  int facing = 0;      ///< Inside the image.
  int seen = 0;        ///< Not behind an observed surface.
  int agreeing = 0;    ///< On the observed surface with the same normal, where it is searched.
  int free_space = 0;  ///< Clearly in front of the observed surface: the ray went through.

  /// Larger is better: the agreeing share of the visible points, lower where few are visible.
  float score() const {
    constexpr int kDoubt = 6;             // points without which a share says little
    constexpr float kHiddenWorth = 0.5f;  // what a pose keeps of its score when all is hidden
    return static_cast<float>(agreeing - free_space) / static_cast<float>(seen + kDoubt) *
           (static_cast<float>(seen) / static_cast<float>(facing + 1) + kHiddenWorth);
  }
};

/// Tolerances of a check. The options that hold one say their defaults.
struct CheckTolerance {
  BPA_OPTION(double, depth_m, 0, (1e-4, 1),
             "Depth difference of a model point on the surface, metres.");
  BPA_OPTION(double, free_depth_m, 0, (1e-4, 1),
             "A point this far in front of the surface is in free space, metres. The paper has "
             "0.05 (V.3).");
  BPA_OPTION(double, normal_cosine, 0, (-1, 1),
             "Smallest cosine between the normals of model and surface.");
};

/// How many of the model's points a check looks at.
struct CheckCount {
  int points = 0;
  /// Where fewer than `few_seen` of these are in sight, some agree and at most half of them are in
  /// free space, the check goes on with further points: until `few_seen` are in sight, or up to
  /// `most_points`.
  int few_seen = 0;
  int most_points = 0;
};

/// Checks a pose. Rejects early, with few agreeing points counted, when most of the first ones
/// disagree.
PoseCheck check_pose(const CheckImage& image, const CheckPoints& model, const FastPose& pose,
                     const CheckCount& count, const CheckTolerance& tolerance);

}  // namespace bpa::score
