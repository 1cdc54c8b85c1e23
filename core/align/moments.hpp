// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/align/correspondence.hpp"

namespace bpa::align {

/// All that positions and normals say about the pose. With R = camera_from_object's rotation the
/// log likelihood is, up to a constant,
///
///   constant + trace(R attitude) - weight / 2 |R model_centroid + t - scene_centroid|²:
///
/// with the constant such that perfect agreement gives 0. About the weighted centroids, orientation
/// and position come apart (README.md).
struct Moments {
  double weight = 0;                                         ///< Σ 1 / σ².
  Eigen::Vector3d model_centroid = Eigen::Vector3d::Zero();  ///< Weighted means of the points.
  Eigen::Vector3d scene_centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d attitude = Eigen::Matrix3d::Zero();  ///< Σ of (model vector)(scene vector)ᵀ.
  double constant = 0;
};

/// A pair's curvature direction, of weight 2 b. It adds b (p pᵀ + p' p'ᵀ) to `attitude`, the
/// model's directions on the left; with the reverse sign it subtracts that.
struct CurvatureTerm {
  Eigen::Matrix3d attitude = Eigen::Matrix3d::Zero();
  double largest = 0;  ///< The most it can add to the log likelihood, -λ3 / 2. 0: no direction.

  /// What it adds to the log likelihood at a rotation, for the sign as given.
  double value(const Eigen::Matrix3d& rotation) const {
    return rotation.cwiseProduct(attitude.transpose()).sum();
  }
};

/// The curvature terms of the first kCapacity curved pairs, kept; later ones are computed again
/// each time, so that nothing is allocated.
class CurvatureTerms {
 public:
  static constexpr int kCapacity = 24;

  void add(const CurvatureTerm& term);
  /// Of all terms, kept or not.
  int count() const { return count_; }
  double total() const { return total_; }  ///< Σ of `largest`.
  const CurvatureTerm& strongest() const { return strongest_; }

  /// Calls visit(term) for every pair with a curvature direction, in order.
  void for_each(const Correspondences& data, auto&& visit) const;

 private:
  std::array<CurvatureTerm, kCapacity> kept_;
  CurvatureTerm strongest_;
  int count_ = 0;
  double total_ = 0;
};

/// The moments of positions (a position prior among them, as if isotropic) and normals. `curvature`
/// gets the curvature directions, whose share that does not depend on their signs is in the
/// moments.
Moments accumulate(const Correspondences& data, CurvatureTerms& curvature);

/// Of positions alone: Horn's.
Moments accumulate_positions(const Correspondences& data);

/// The curvature term of one pair.
CurvatureTerm curvature_term(const OrientedPair& pair);

/// [v]×: the matrix of the cross product with v.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

/// The exponent whose value at q is trace(R(q) attitude): Horn's matrix (1987).
Eigen::Matrix4d horn_matrix(const Eigen::Matrix3d& attitude);

void CurvatureTerms::for_each(const Correspondences& data, auto&& visit) const {
  const int kept = count_ < kCapacity ? count_ : kCapacity;
  for (int i = 0; i < kept; ++i) visit(kept_[i]);
  if (kept == count_) return;
  int seen = 0;
  for (const OrientedPair& pair : data.oriented) {
    const CurvatureTerm term = curvature_term(pair);
    if (term.largest > 0 && ++seen > kept) visit(term);
  }
}

}  // namespace bpa::align
