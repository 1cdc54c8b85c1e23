// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <bpa/core/cloud/point_cloud.hpp>

namespace bpa {

/// The four rigid invariants of two oriented points (Drost et al., CVPR 2010).
struct PointPairFeature {
  float distance = 0;       ///< Metres.
  float angle_first = 0;    ///< Between the first normal and the line to the second, radians.
  float angle_second = 0;   ///< Between the second normal and that line.
  float angle_normals = 0;  ///< Between the normals.
};

PointPairFeature point_pair_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                    const Eigen::Vector3f& q, const Eigen::Vector3f& nq);

/// All ordered pairs of a model's points, found by their quantised feature. Pairs of (nearly)
/// coplanar points with parallel normals are left out: they fix no pose.
class PointPairTable {
 public:
  /// `distance_step` in metres, `angle_step` in radians.
  PointPairTable(const PointCloud& points, float distance_step, float angle_step);

  using Pair = std::pair<std::uint16_t, std::uint16_t>;
  /// The model pairs whose feature falls in the same cell.
  std::span<const Pair> lookup(const PointPairFeature& feature) const;
  float max_distance() const { return max_distance_; }

  /// True when the pair fixes a pose: normals that differ by 20 degrees or more, or points that are
  /// not in one another's tangent plane.
  static bool informative(const PointPairFeature& feature);

 private:
  std::uint32_t key(const PointPairFeature& feature) const;

  float distance_step_ = 1;
  float angle_step_ = 1;
  float max_distance_ = 0;
  int angle_bins_ = 1;
  std::vector<std::uint32_t> first_;  // first_[key]..first_[key + 1] is the cell
  std::vector<Pair> pairs_;
};

}  // namespace bpa
