// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/detect/options.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/scene_features.hpp"

namespace bpa::detect {

struct Refinement {
  Pose frame_from_object;  ///< The frame is the camera's, or the one that several views share.
  /// Information (inverse covariance) about that frame's axes, of (translation of the object's
  /// origin, rotation), from the correspondences used last. SI units.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  int num_correspondences = 0;
};

/// Gradient-based alignment (V.7): Gauss-Newton on two kinds of distances. One is from a model
/// point to the observed tangent plane at the pixel it falls on. The other is from the edges of the
/// model's nearest view to those of the observed surface.
Refinement refine_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                       const RefinementOptions& options);
/// The same pose alone, which takes one step less.
Pose aligned_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                  const RefinementOptions& options);

}  // namespace bpa::detect
