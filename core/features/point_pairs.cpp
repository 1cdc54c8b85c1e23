// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <bpa/core/features/point_pairs.hpp>

namespace bpa {
namespace {

float safe_acos(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

}  // namespace

PointPairFeature point_pair_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                    const Eigen::Vector3f& q, const Eigen::Vector3f& nq) {
  const Eigen::Vector3f line = q - p;
  const float distance = line.norm();
  const float inverse = distance > 1e-9f ? 1 / distance : 0;
  return {distance, safe_acos(np.dot(line) * inverse), safe_acos(nq.dot(line) * inverse),
          safe_acos(np.dot(nq))};
}

bool PointPairTable::informative(const PointPairFeature& f) {
  constexpr float kRightAngle = 1.5707963f;
  return f.angle_normals > 0.35f || std::abs(f.angle_first - kRightAngle) > 0.35f;
}

std::uint32_t PointPairTable::key(const PointPairFeature& f) const {
  const auto angle = [&](float value) {
    return static_cast<std::uint32_t>(
        std::min(static_cast<int>(value / angle_step_), angle_bins_ - 1));
  };
  const auto bins = static_cast<std::uint32_t>(angle_bins_);
  const auto distance = static_cast<std::uint32_t>(f.distance / distance_step_);
  return ((distance * bins + angle(f.angle_first)) * bins + angle(f.angle_second)) * bins +
         angle(f.angle_normals);
}

PointPairTable::PointPairTable(const PointCloud& points, float distance_step, float angle_step)
    : distance_step_(distance_step),
      angle_step_(angle_step),
      angle_bins_(static_cast<int>(std::ceil(3.14159274f / angle_step))) {
  const std::size_t count = std::min<std::size_t>(points.size(), 65535);
  std::vector<std::pair<std::uint32_t, Pair>> entries;
  entries.reserve(count * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      if (i == j) continue;
      const PointPairFeature feature = point_pair_feature(points.points[i], points.normals[i],
                                                          points.points[j], points.normals[j]);
      if (feature.distance < distance_step || !informative(feature)) continue;
      max_distance_ = std::max(max_distance_, feature.distance);
      entries.push_back(
          {key(feature), {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)}});
    }
  }
  std::sort(entries.begin(), entries.end());
  const std::uint32_t last_key = entries.empty() ? 0 : entries.back().first;
  first_.assign(last_key + 2, 0);
  for (const auto& entry : entries) ++first_[entry.first + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  pairs_.reserve(entries.size());
  for (const auto& entry : entries) pairs_.push_back(entry.second);
}

std::span<const PointPairTable::Pair> PointPairTable::lookup(const PointPairFeature& f) const {
  if (!(f.distance <= max_distance_ + distance_step_)) return {};
  const std::uint32_t cell = key(f);
  if (cell + 1 >= first_.size()) return {};
  return std::span<const Pair>(pairs_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
}

}  // namespace bpa
