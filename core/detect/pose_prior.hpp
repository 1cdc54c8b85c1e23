// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/random.hpp"
#include "core/base/status.hpp"
#include "core/bingham/bingham.hpp"
#include "core/model/object_model.hpp"
#include "core/result/pose_prior.hpp"

// Pose priors: what a caller knows of an object's pose before the search, from tracking, touch or a
// robot's own placing. A prior is a Gaussian of the position times a Bingham of the orientation. It
// applies with probability `weight`. Poses sampled from it are hypotheses, like those from
// features, so that an object with few features is found too. It is also a factor of the score. p
// is the pose's density under the prior, u that under a uniform distribution. A placement gains the
// log odds
//
//   log((1 - weight) + weight p / u).

namespace bpa::detect {

/// Checks the numbers (finite), the weight (range) and the covariance (symmetric, positive
/// definite). Concentrations must not be positive; axes are orthonormal unless all concentrations
/// are zero. The message names the field, its value and the rule, after `name`.
Status validate(const PosePrior& prior, const std::string& name);

/// The Bingham of the prior's orientation.
Bingham orientation_of(const PosePrior& prior);

/// The same prior of a_from_object, from one of b_from_object.
PosePrior transformed(const Pose& a_from_b, const PosePrior& prior);

/// The uniform distribution that a prior is compared with: the origin anywhere in this volume (over
/// a table), every orientation.
constexpr double kBackgroundVolume = 1;  // m³
/// Largest log odds that priors add or subtract (150 to 1): a clear image outweighs a wrong prior.
constexpr double kMostPriorEvidence = 5;
/// Standard deviations of a placement's position and rotation, which widen the priors: half of the
/// tolerance within which a placement is right.
constexpr double kPlacementSigma_m = 0.5 * kPoseTolerance_m;
constexpr double kPlacementSigma_rad = 0.5 * kPoseTolerance_rad;

/// The priors of one model. Those of other models are ignored; each must be valid.
class ModelPriors {
 public:
  ModelPriors(std::span<const PosePrior> priors, const ObjectModel& model);

  bool empty() const { return priors_.empty(); }

  /// The log odds that a placement of the model gains, within ±kMostPriorEvidence; 0 without
  /// priors. Modulo the model's symmetry: p is the mean over the poses that look the same. Several
  /// priors are of different instances, each equally likely: the mean of the logarithm's argument.
  double evidence(const Pose& camera_from_object) const;

  /// `count` poses sampled from each prior, camera frame. Where the position is unknown, a model
  /// point is put on a random point of `surface`. Of a few random model points it is the one whose
  /// normal agrees best. No such poses for an empty `surface`.
  std::vector<Pose> draw(const PointCloud& surface, int count, RandomStream& random) const;

 private:
  struct Prior {
    double weight = 0;
    std::optional<PositionPrior> position;
    Bingham orientation;
    // Widened, and the logarithm of what makes exp(-d² / 2) and exp(qᵀ C q) a ratio of densities.
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double log_position_peak = 0;
    Bingham widened;
    double log_orientation_peak = 0;

    double ratio(const Pose& pose) const;
  };
  static Prior prepare(const PosePrior& prior);
  double mean_ratio(const Prior& prior, const Pose& pose) const;

  const ObjectModel& model_;
  std::vector<Prior> priors_;
  std::vector<Pose> same_;  ///< object_from_object: the motions of the symmetry.
};

}  // namespace bpa::detect
