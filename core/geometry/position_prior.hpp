// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace bpa {

/// A Gaussian of a position: where an object's origin is in the camera frame.
struct PositionPrior {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();            ///< Metres.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< m².
};

}  // namespace bpa
