// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/geometry/pose.hpp"
#include "core/result/placement.hpp"

namespace bpa {

/// What a caller knows beforehand of one object's pose: in the camera frame, or the fixed frame of
/// several views.
struct PosePrior {
  std::string model;  ///< The model's name.
  /// Of frame_from_object's translation, metres; none: the position is unknown.
  std::optional<PositionPrior> position;
  /// Of frame_from_object's rotation; concentrations of zero: the orientation is unknown.
  OrientationUncertainty orientation;
  double weight = 0.95;  ///< Probability that this prior applies, in (0, 1].
};

}  // namespace bpa
