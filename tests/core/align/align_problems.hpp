// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/align/correspondence.hpp"
#include "core/base/random.hpp"
#include "core/geometry/pose.hpp"

// Random alignment problems for the tests.

namespace bpa::align {

inline Eigen::Vector3d random_vector(RandomStream& random, double scale = 1) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return scale * Eigen::Vector3d(x, y, z);
}

inline Eigen::Quaterniond random_rotation(RandomStream& random) { return Bingham().sample(random); }

/// An object about a metre in front of the camera.
inline Pose random_pose(RandomStream& random) {
  return {random_rotation(random), Eigen::Vector3d(0, 0, 1) + random_vector(random, 0.2)};
}

/// A feature on an object of about 10 cm.
inline OrientedPoint random_feature(RandomStream& random, double kappa, double lambda3) {
  return {random_vector(random, 0.05), random_rotation(random), kappa, lambda3};
}

/// The Bingham of a feature's true orientation given the observed one (paper, appendix).
inline Bingham feature_bingham(const OrientedPoint& feature) {
  return Bingham::about(feature.orientation, {feature.lambda3, feature.kappa, feature.kappa});
}

/// A pair drawn from the model: the scene's point is off by σ per axis, its orientation by the
/// pair's Bingham.
inline OrientedPair draw_pair(const OrientedPoint& model, const Pose& camera_from_object,
                              double sigma, double scene_kappa, double scene_lambda3,
                              RandomStream& random) {
  OrientedPair pair;
  pair.model = model;
  pair.sigma = sigma;
  pair.scene = {camera_from_object * model.point + random_vector(random, sigma), model.orientation,
                scene_kappa, scene_lambda3};
  const FeatureConcentration c = compose(pair.model, pair.scene);
  const Bingham deviation =
      Bingham::about(Eigen::Quaterniond::Identity(), {c.lambda3, c.kappa, c.kappa});
  pair.scene.orientation =
      (camera_from_object.rotation * model.orientation * deviation.sample(random)).normalized();
  return pair;
}

}  // namespace bpa::align
