// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry/pose.hpp"
#include "core/model/model_index.hpp"
#include "core/observation/check_image.hpp"

namespace bpa::score {

/// Least `min_facing` of pose checks; chosen by hand.
constexpr float kCheckFacing = 0.15f;

/// Some model points as the camera sees them.
struct ProjectedBlock {
  float point[3][kCheckBlock];   ///< Camera frame, metres.
  float normal[3][kCheckBlock];  ///< Camera frame.
  int pixel[kCheckBlock];        ///< -1 where the point faces away or is outside the image.

  /// Sets all for the kCheckBlock points from `first`, a multiple of kCheckBlock. A point faces the
  /// camera if the cosine between its normal and the line of sight is at least `min_facing`, on the
  /// optical axis.
  void project(const CheckImage& image, const CheckPoints& model, const FastPose& pose, int first,
               float min_facing = kCheckFacing);
};

}  // namespace bpa::score
