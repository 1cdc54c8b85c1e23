// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/neighbor_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bpa {
namespace {

constexpr int kBits = 21;
constexpr int kOffset = 1 << (kBits - 1);

// Cells ordered by z, then y, then x, so that a row along x is consecutive.
std::uint64_t key_of(int x, int y, int z) {
  const auto part = [](int value) {
    return static_cast<std::uint64_t>(std::clamp(value + kOffset, 0, (1 << kBits) - 1));
  };
  return (part(z) << (2 * kBits)) | (part(y) << kBits) | part(x);
}

// A number that no int holds, or NaN, is in a cell beyond all others.
Eigen::Vector3i cell_at(const Eigen::Vector3f& point, float inverse_cell) {
  constexpr auto kBeyond = static_cast<float>(kOffset + 4);
  const auto cell = [=](float value) {
    if (!(value > -kBeyond)) return -kOffset - 4;
    return static_cast<int>(std::floor(std::min(value, kBeyond)));
  };
  const Eigen::Vector3f scaled = point * inverse_cell;
  return {cell(scaled.x()), cell(scaled.y()), cell(scaled.z())};
}

std::vector<std::uint64_t> keys_of(std::span<const Eigen::Vector3f> points, float inverse_cell) {
  std::vector<std::uint64_t> keys;
  keys.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3i cell = cell_at(point, inverse_cell);
    keys.push_back(key_of(cell.x(), cell.y(), cell.z()));
  }
  return keys;
}

// The indices of the points in the order of their keys.
std::vector<std::uint32_t> sort_by_key(const std::vector<std::uint64_t>& keys) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  sorted.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    sorted.emplace_back(key, static_cast<std::uint32_t>(sorted.size()));
  }
  std::ranges::sort(sorted);
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, i] : sorted) order.push_back(i);
  return order;
}

struct Mean {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  float count = 0;

  void add(const PointCloud& cloud, std::size_t i) {
    point += cloud.points[i];
    if (!cloud.normals.empty()) normal += cloud.normals[i];
    if (!cloud.colors.empty()) {
      for (int k = 0; k < 3; ++k) color[k] += cloud.colors[i][k];
    }
    count += 1;
  }

  void append_to(PointCloud& out, const PointCloud& source) const {
    if (count == 0) return;
    if (!source.normals.empty()) {
      if (normal.squaredNorm() < 1e-6f) return;
      out.normals.push_back(normal.normalized());
    }
    out.points.push_back(point / count);
    if (source.colors.empty()) return;
    const Eigen::Vector3f mean = (color / count).array().round();
    out.colors.push_back({static_cast<std::uint8_t>(mean[0]), static_cast<std::uint8_t>(mean[1]),
                          static_cast<std::uint8_t>(mean[2])});
  }
};

}  // namespace

NeighborGrid::NeighborGrid(std::span<const Eigen::Vector3f> points, float radius)
    : inverse_cell_(1 / radius), radius_squared_(radius * radius) {
  const std::vector<std::uint64_t> keys = keys_of(points, inverse_cell_);
  order_ = sort_by_key(keys);
  for (const std::uint32_t i : order_) {
    keys_.push_back(keys[i]);
    points_.push_back(points[i]);
  }
}

Eigen::Vector3i NeighborGrid::cell_of(const Eigen::Vector3f& point) const {
  return cell_at(point, inverse_cell_);
}

std::pair<std::ptrdiff_t, std::ptrdiff_t> NeighborGrid::row(int x, int y, int z) const {
  const auto first = std::lower_bound(keys_.begin(), keys_.end(), key_of(x, y, z));
  const auto last = std::upper_bound(first, keys_.end(), key_of(x + 2, y, z));
  return {first - keys_.begin(), last - keys_.begin()};
}

PointCloud downsample(const PointCloud& cloud, float spacing) {
  const std::vector<std::uint64_t> keys = keys_of(cloud.points, 1 / spacing);
  const std::vector<std::uint32_t> order = sort_by_key(keys);
  PointCloud out;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last < order.size() && keys[order[last]] == keys[order[first]]) ++last;
    Mean sides[2];
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t i = order[k];
      const bool has_normals = !cloud.normals.empty();
      if (has_normals && cloud.normals[i].squaredNorm() == 0) continue;
      const bool other_side = has_normals && sides[0].normal.dot(cloud.normals[i]) < 0;
      sides[other_side ? 1 : 0].add(cloud, i);
    }
    for (const Mean& side : sides) side.append_to(out, cloud);
    first = last;
  }
  return out;
}

}  // namespace bpa
