// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/point_pairs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bpa {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kAngleStep = kPi / kPairAngleBins;
constexpr float kFixingAngle = 0.35f;  // radians, 20 degrees; chosen by hand
constexpr float kOuterPart = 0.25f;    // of a bin, from which the next bin is searched too

float safe_acos(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

// The bins a value is found in: its own, and the next one where it lies in the outer quarter.
struct Bins {
  int first = 0, last = 0;
};

Bins bins_of(float scaled, int count) {
  const int own = std::min(static_cast<int>(scaled), count - 1);
  const float inside = scaled - static_cast<float>(own);
  return {inside < kOuterPart ? std::max(0, own - 1) : own,
          inside > 1 - kOuterPart ? std::min(count - 1, own + 1) : own};
}

// Calls visit(key) for every cell that the feature is found in.
template <class Visit>
void for_each_key(const PointPairFeature& f, float inverse_step, const Visit& visit) {
  const Bins d = bins_of(f.distance * inverse_step, 1 << 20);
  const Bins a = bins_of(f.angle_first / kAngleStep, kPairAngleBins);
  const Bins b = bins_of(f.angle_second / kAngleStep, kPairAngleBins);
  const Bins c = bins_of(f.angle_normals / kAngleStep, kPairAngleBins);
  for (int i = d.first; i <= d.last; ++i) {
    for (int j = a.first; j <= a.last; ++j) {
      for (int k = b.first; k <= b.last; ++k) {
        for (int l = c.first; l <= c.last; ++l) {
          visit(static_cast<std::uint32_t>(
              ((i * kPairAngleBins + j) * kPairAngleBins + k) * kPairAngleBins + l));
        }
      }
    }
  }
}

}  // namespace

PointPairFeature point_pair_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                    const Eigen::Vector3f& q, const Eigen::Vector3f& nq) {
  const Eigen::Vector3f line = q - p;
  const float distance = line.norm();
  const float inverse = distance > 1e-9f ? 1 / distance : 0;
  return {distance, safe_acos(np.dot(line) * inverse), safe_acos(nq.dot(line) * inverse),
          safe_acos(np.dot(nq))};
}

bool fixes_pose(const PointPairFeature& f) {
  return f.angle_normals > kFixingAngle || std::abs(f.angle_first - 0.5f * kPi) > kFixingAngle;
}

Eigen::Matrix3f basis_of(const Eigen::Vector3f& normal) {
  const Eigen::Vector3f helper =
      std::abs(normal.x()) < 0.6f ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  Eigen::Matrix3f basis;
  basis.col(0) = (helper - normal * normal.dot(helper)).normalized();
  basis.col(1) = normal.cross(basis.col(0));
  basis.col(2) = normal;
  return basis;
}

std::uint16_t pair_angle_key(const PointPairFeature& f) {
  const auto bin = [](float angle) {
    return std::min(static_cast<int>(angle / kAngleStep), kPairAngleBins - 1);
  };
  return static_cast<std::uint16_t>((bin(f.angle_first) * kPairAngleBins + bin(f.angle_second)) *
                                        kPairAngleBins +
                                    bin(f.angle_normals));
}

std::uint8_t turn_of(const Eigen::Matrix3f& basis, const Eigen::Vector3f& line) {
  const float angle = std::atan2(basis.col(1).dot(line), basis.col(0).dot(line));
  const float steps = angle * (kTurnSteps / (2 * kPi));
  return static_cast<std::uint8_t>(static_cast<int>(std::floor(steps + 0.5f)) & (kTurnSteps - 1));
}

PointPairTable::PointPairTable(const PointCloud& points, float distance_step)
    : inverse_step_(1 / distance_step) {
  const std::size_t count = std::min<std::size_t>(points.size(), 65535);
  std::vector<Eigen::Matrix3f> bases(count);
  for (std::size_t i = 0; i < count; ++i) bases[i] = basis_of(points.normals[i]);
  // Twice over the pairs: how many there are of each key, then where each goes.
  const auto for_each_pair = [&](const auto& visit) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        const PointPairFeature feature = point_pair_feature(points.points[i], points.normals[i],
                                                            points.points[j], points.normals[j]);
        if (feature.distance >= distance_step && fixes_pose(feature)) visit(i, j, feature);
      }
    }
  };
  for_each_pair([&](std::size_t, std::size_t, const PointPairFeature& feature) {
    max_distance_ = std::max(max_distance_, feature.distance);
    for_each_key(feature, inverse_step_, [&](std::uint32_t key) {
      if (key + 2 > first_.size()) first_.resize(key + 2, 0);
      ++first_[key + 1];
    });
  });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  entries_.resize(first_.empty() ? 0 : first_.back());
  std::vector<std::uint32_t> next = first_;
  for_each_pair([&](std::size_t i, std::size_t j, const PointPairFeature& feature) {
    const Entry entry{static_cast<std::uint16_t>(i),
                      turn_of(bases[i], points.points[j] - points.points[i])};
    for_each_key(feature, inverse_step_, [&](std::uint32_t key) { entries_[next[key]++] = entry; });
  });
}

}  // namespace bpa
