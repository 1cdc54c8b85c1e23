// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/samples.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

namespace bpa::align {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double effective_sample_size(std::span<const WeightedPose> samples) {
  double sum = 0, squares = 0;
  for (const WeightedPose& s : samples) {
    sum += s.weight;
    squares += s.weight * s.weight;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

double PositionRegion::squared_distance(const Vector3d& position) const {
  const Vector3d difference = position - centre;
  return difference.dot(covariance.ldlt().solve(difference));
}

PositionRegion position_region(std::span<const WeightedPose> samples, double probability) {
  PositionRegion region;
  double total = 0;
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    total += samples[i].weight;
    region.centre += samples[i].weight * samples[i].camera_from_object.translation;
  }
  if (!(total > 0)) return region;
  region.centre /= total;
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const Vector3d d = samples[i].camera_from_object.translation - region.centre;
    region.covariance += (samples[i].weight / total) * d * d.transpose();
  }
  std::vector<std::pair<double, double>> by_distance;
  double other_total = 0;
  for (std::size_t i = 1; i < samples.size(); i += 2) {
    by_distance.emplace_back(region.squared_distance(samples[i].camera_from_object.translation),
                             samples[i].weight);
    other_total += samples[i].weight;
  }
  std::sort(by_distance.begin(), by_distance.end());
  double weight = 0;
  for (const auto& [squared_distance, w] : by_distance) {
    weight += w;
    region.squared_radius = squared_distance;
    if (weight >= probability * other_total) break;
  }
  return region;
}

}  // namespace bpa::align
