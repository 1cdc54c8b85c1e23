// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/cloud/frame.hpp"
#include "core/doctor/finding.hpp"
#include "core/model/object_model.hpp"

namespace bpa::doctor {

/// What the detector is set to (DetectorOptions).
struct DetectorLimits {
  double max_range_m = 2.5;  ///< Surface farther away is not searched.
  int max_width = 400;       ///< Wider frames are halved until they are not wider, pixels.
  int check_points = 64;     ///< Points that a pose is checked with.
};

/// Pairs of models that one may be taken for the other: nearly the same shape, and nearly the same
/// colours unless `with_color` is false or one has none. Some seconds for each pair of equal size.
Findings check_look_alikes(const std::vector<ModelSource>& models, bool with_color,
                           int num_threads = 0);

/// What is wrong with looking for these models in this frame, whose depth is clean
/// (clean_depth()): too small or too large in it, or without colour.
Findings check_models_in_frame(const std::vector<ModelSource>& models, const Frame& frame,
                               const DetectorLimits& limits);

}  // namespace bpa::doctor
