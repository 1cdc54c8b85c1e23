// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/geometry/pose.hpp"

namespace bpa::align {

/// A draw of camera_from_object with its importance weight.
struct WeightedPose {
  Pose camera_from_object;
  double weight = 1;
};

/// (Σ w)² / Σ w²: how many equally weighted draws these are worth.
double effective_sample_size(std::span<const WeightedPose> samples);

/// An ellipsoid of positions of the object's origin, camera frame, metres.
struct PositionRegion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m².
  double squared_radius = 0;                             ///< In standard deviations.

  double squared_distance(const Eigen::Vector3d& position) const;
  bool contains(const Eigen::Vector3d& position) const {
    return squared_distance(position) <= squared_radius;
  }
};

/// The ellipsoid about the weighted mean, shaped by the weighted covariance and just large enough
/// to hold `probability` of the weight. Positions need not be Gaussian for that to be right. Centre
/// and shape come from every other sample and the radius from the rest, so that a further draw is
/// inside with that probability and not, as from the samples that made the shape, a little less
/// often.
PositionRegion position_region(std::span<const WeightedPose> samples, double probability);

}  // namespace bpa::align
