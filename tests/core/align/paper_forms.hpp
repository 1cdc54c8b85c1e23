// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "core/align/moments.hpp"
#include "core/align/posterior.hpp"
#include "tests/core/align/anisotropy.hpp"

// The paper's own forms of what core/align computes in another way: claims 1 and 2, and its
// sampler.

namespace bpa::align {

/// Claim 2: the Bingham with Λ = (-2ab/σ², -2ab/σ², 0), V = s' ∘ W ∘ s, that one position pair
/// leaves when `model` (of length a, about the centre of rotation) turns towards `scene` (of length
/// b).
inline Bingham position_bingham(const Eigen::Vector3d& model, const Eigen::Vector3d& scene,
                                double sigma) {
  const Eigen::Quaterniond s = Eigen::Quaterniond::FromTwoVectors(model, Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond s_prime =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), scene);
  const double lambda = -2 * model.norm() * scene.norm() / (sigma * sigma);
  return Bingham::about(s_prime, {0, lambda, lambda}).rotated_right(s);
}

/// The exponent of the pairs' orientations and of the prior's: the product of their Binghams.
inline Eigen::Matrix4d orientation_exponent(const Correspondences& data) {
  Eigen::Matrix4d exponent = Eigen::Matrix4d::Zero();
  for (const OrientedPair& pair : data.oriented) {
    const FeatureConcentration c = compose(pair.model, pair.scene);
    exponent += Bingham::about(pair.scene.orientation, {c.lambda3, c.kappa, c.kappa})
                    .rotated_right(pair.model.orientation.conjugate())
                    .exponent();
  }
  if (data.orientation_prior != nullptr) exponent += data.orientation_prior->exponent();
  return exponent;
}

/// p(q | t, Z) for a given translation of camera_from_object: claims 1 and 2, with the signs of
/// curvature directions as given. The product of one Bingham for each pair.
inline Bingham conditional_orientation(const Correspondences& data,
                                       const Eigen::Vector3d& translation) {
  // About the object's origin, which is at `translation`: the pairs turn x to y - t.
  Eigen::Matrix3d attitude = Eigen::Matrix3d::Zero();
  const auto add = [&](const Eigen::Vector3d& model, const Eigen::Vector3d& scene, double sigma) {
    attitude += (model / (sigma * sigma)) * (scene - translation).transpose();
  };
  for (const OrientedPair& pair : data.oriented) {
    add(pair.model.point, pair.scene.point, pair.sigma);
  }
  for (const PositionPair& pair : data.positions) add(pair.model, pair.scene, pair.sigma);
  return Bingham::from_exponent(horn_matrix(attitude) + orientation_exponent(data));
}

/// The paper's sampler: t from a Gaussian about the least-squares translation, q from the Bingham
/// p(q | t, Z), weights p(q, t | Z) over both. Isotropic noise and oriented pairs only, curvature
/// signs as given.
inline SampledPosterior sample_translation_first(const Correspondences& data, int count,
                                                 RandomStream& random) {
  const Posterior isotropic = posterior(data);
  // A little wider than the posterior, so that no weight grows large.
  const Eigen::Matrix3d covariance = 1.5 * isotropic.covariance().topLeftCorner<3, 3>();
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  const Eigen::Matrix4d exponent = orientation_exponent(data);
  SampledPosterior result;
  result.samples.resize(static_cast<std::size_t>(count));
  for (WeightedPose& s : result.samples) {
    Eigen::Vector3d z;
    for (int i = 0; i < 3; ++i) z[i] = random.normal();
    Pose& pose = s.camera_from_object;
    pose.translation = isotropic.map.camera_from_object.translation + factor.matrixL() * z;
    const Bingham conditional = conditional_orientation(data, pose.translation);
    pose.rotation = conditional.sample(random);
    const Eigen::Quaterniond& q = pose.rotation;
    const Eigen::Vector4d wxyz(q.w(), q.x(), q.y(), q.z());
    double log_likelihood = wxyz.dot(exponent * wxyz);
    for (const OrientedPair& p : data.oriented) {
      const Eigen::Vector3d off = pose * p.model.point - p.scene.point;
      log_likelihood -= 0.5 * off.squaredNorm() / (p.sigma * p.sigma);
    }
    s.weight = log_likelihood + 0.5 * z.squaredNorm() - conditional.log_density(q);
  }
  double largest = -INFINITY, sum = 0, squares = 0;
  for (const WeightedPose& s : result.samples) largest = std::max(largest, s.weight);
  for (WeightedPose& s : result.samples) sum += (s.weight = std::exp(s.weight - largest));
  for (WeightedPose& s : result.samples) {
    s.weight /= sum;
    squares += s.weight * s.weight;
  }
  result.effective_sample_size = 1 / squares;
  return result;
}

}  // namespace bpa::align
