// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include <bpa/core/align/correspondence.hpp>

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

/// The moments of positions (a position prior among them, as if isotropic) and normals, without the
/// curvature directions.
Moments accumulate(const Correspondences& data);

/// What a pair's curvature direction adds to `attitude`, for its sign as given and for the reverse.
struct CurvatureAttitude {
  Eigen::Matrix3d along_normal;
  Eigen::Matrix3d along_curvature;
  double constant = 0;
  bool present = false;  ///< False when lambda3 is 0 at either end; then the rest is not set.

  Eigen::Matrix3d with_sign(bool reversed) const {
    return reversed ? Eigen::Matrix3d(along_normal - along_curvature)
                    : Eigen::Matrix3d(along_normal + along_curvature);
  }
};
CurvatureAttitude curvature_attitude(const OrientedPair& pair);

/// Adds all curvature directions, each with the sign that agrees with `rotation`. Returns a hash of
/// the signs.
std::uint64_t add_curvature(const Correspondences& data, const Eigen::Matrix3d& rotation,
                            Moments& moments);
/// Adds all curvature directions with the signs they came with.
void add_curvature(const Correspondences& data, Moments& moments);

/// The exponent whose value at q is trace(R(q) attitude): Horn's matrix (1987).
Eigen::Matrix4d horn_matrix(const Eigen::Matrix3d& attitude);

}  // namespace bpa::align
