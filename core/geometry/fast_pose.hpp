// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose.hpp"

namespace bpa {

/// A rigid transform in single precision, as a matrix, for inner loops.
struct FastPose {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();  ///< Metres.

  Eigen::Vector3f operator*(const Eigen::Vector3f& point) const {
    return rotation * point + translation;
  }
};

inline FastPose to_fast(const Pose& pose) {
  return {pose.matrix().cast<float>(), pose.translation.cast<float>()};
}
inline Pose to_pose(const FastPose& pose) {
  return Pose::from_matrix(pose.rotation.cast<double>(), pose.translation.cast<double>());
}

}  // namespace bpa
