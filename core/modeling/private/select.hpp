// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// The points of these indices, with normals and colours.
inline PointCloud select(const PointCloud& cloud, const std::vector<int>& indices) {
  PointCloud out;
  for (const int i : indices) {
    out.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
    if (!cloud.colors.empty()) out.colors.push_back(cloud.colors[i]);
  }
  return out;
}

/// The points whose index meets a condition.
template <std::predicate<int> Condition>
PointCloud select(const PointCloud& cloud, const Condition& condition) {
  std::vector<int> indices;
  for (int i = 0; i < static_cast<int>(cloud.size()); ++i) {
    if (condition(i)) indices.push_back(i);
  }
  return select(cloud, indices);
}

}  // namespace bpa
