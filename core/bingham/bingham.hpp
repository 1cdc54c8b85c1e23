// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/base/random.hpp"
#include "core/bingham/eigen4.hpp"

namespace bpa {

/// The Bingham distribution of orientations (paper, appendix), antipodally symmetric on S3:
///
///   p(q) = exp(qᵀ C q) / F,   C = Σ λi vi viᵀ.
///
/// q is a unit quaternion (w, x, y, z). A value: axes and concentrations, nothing cached. C is
/// determined up to a multiple of the identity. Here its largest eigenvalue is 0, so λ = (0, λ1,
/// λ2, λ3) descends from the mode. The paper counts the other way, λ1 ≤ λ2 ≤ λ3 ≤ 0, without the
/// mode's zero. Densities are with respect to the surface measure of S3, of total 2π²; both q and
/// -q count.
class Bingham {
 public:
  /// The uniform distribution.
  Bingham() : lambda_(Eigen::Vector4d::Zero()), axes_(Eigen::Matrix4d::Identity()) {}

  /// p(q) proportional to exp(qᵀ exponent q), for any finite symmetric matrix.
  static Bingham from_exponent(const Eigen::Matrix4d& exponent);
  /// From the paper's parameters: orthonormal axes v1 v2 v3 as columns (w, x, y, z) and
  /// concentrations of any sign and order.
  static Bingham from_axes(const Eigen::Vector3d& lambda, const Eigen::Matrix<double, 4, 3>& axes);
  /// About `mode`: q = mode ∘ e, where e = (ew, ex, ey, ez) is a deviation in the body frame. Its
  /// exponent is λ[0] ex² + λ[1] ey² + λ[2] ez². λ ≤ 0.
  static Bingham about(const Eigen::Quaterniond& mode, const Eigen::Vector3d& lambda);

  /// λ = (0, λ1, λ2, λ3), descending.
  const Eigen::Vector4d& concentrations() const { return lambda_; }
  /// Orthonormal columns (w, x, y, z) for the concentrations; column 0 is the mode.
  const Eigen::Matrix4d& axes() const { return axes_; }
  Eigen::Quaterniond mode() const;
  /// C with its largest eigenvalue 0.
  Eigen::Matrix4d exponent() const;

  double log_normalizer() const;
  /// The exponent qᵀ C q ≤ 0, 0 at the mode; its negative is the "energy" of credible regions.
  double log_ratio_to_mode(const Eigen::Quaterniond& q) const;
  double log_density(const Eigen::Quaterniond& q) const {
    return log_ratio_to_mode(q) - log_normalizer();
  }
  /// E[q qᵀ]; trace 1.
  Eigen::Matrix4d scatter() const;

  /// The distribution of q ∘ r.
  Bingham rotated_right(const Eigen::Quaterniond& r) const;

  /// One exact draw: rejection from an angular central Gaussian (Kent, Ganeiban and Mardia 2013).
  /// `trials`, if given, is increased by the number of proposals.
  Eigen::Quaterniond sample(RandomStream& random, int* trials = nullptr) const;

 private:
  explicit Bingham(const SymmetricEigen4& spectrum);

  Eigen::Vector4d lambda_;
  Eigen::Matrix4d axes_;
};

/// The normalised product of densities: exponents add (paper, appendix).
Bingham product(const Bingham& a, const Bingham& b);
Bingham product(std::span<const Bingham> factors);

/// E[ω ωᵀ] of the rotation vector ω, q = exp(ω) ∘ mode, angle in [0, π], rad²; exact for any
/// concentrations. The axes are those of the frame that q maps into: the 3x3 block of a ROS
/// covariance.
Eigen::Matrix3d rotation_covariance(const Bingham& bingham);

/// Draws x on S3 with density proportional to exp(Σ λi xi²); λ ≤ 0 with the largest entry 0.
/// What Bingham::sample does before its axes turn the answer.
Eigen::Vector4d sample_diagonal_bingham(const Eigen::Vector4d& lambda, RandomStream& random,
                                        int* trials = nullptr);

/// The 4x4 matrices of multiplication: left_product(r) q = r ∘ q and right_product(r) q = q ∘ r.
Eigen::Matrix4d left_product(const Eigen::Quaterniond& r);
Eigen::Matrix4d right_product(const Eigen::Quaterniond& r);

/// A weighted sum of Binghams: orientations that a view cannot decide between.
struct BinghamMixture {
  struct Component {
    double weight = 1;  ///< Positive; the weights of a mixture sum to 1.
    Bingham bingham;
  };
  std::vector<Component> components;

  double log_density(const Eigen::Quaterniond& q) const;
  Eigen::Quaterniond sample(RandomStream& random) const;
};

}  // namespace bpa
