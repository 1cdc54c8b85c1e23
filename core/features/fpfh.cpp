// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/fpfh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa {
namespace {

constexpr int kBins = 11;

int bin_of(float unit) { return std::clamp(static_cast<int>(unit * kBins), 0, kBins - 1); }

// The three angles of a pair in the Darboux frame of the point whose normal is better aligned with
// the line between them. False when the frame is undefined.
bool add_pair(const Eigen::Vector3f& p, const Eigen::Vector3f& np, const Eigen::Vector3f& q,
              const Eigen::Vector3f& nq, Fpfh& histogram) {
  Eigen::Vector3f line = q - p;
  const float distance = line.norm();
  if (distance < 1e-6f) return false;
  line /= distance;
  const float cosine_p = np.dot(line);
  const float cosine_q = nq.dot(line);
  const bool swap = std::abs(cosine_p) < std::abs(cosine_q);
  const Eigen::Vector3f& source = swap ? nq : np;
  const Eigen::Vector3f& target = swap ? np : nq;
  const float phi = swap ? -cosine_q : cosine_p;
  Eigen::Vector3f v = (swap ? Eigen::Vector3f(-line) : line).cross(source);
  const float v_norm = v.norm();
  if (v_norm < 1e-6f) return false;
  v /= v_norm;
  const Eigen::Vector3f w = source.cross(v);
  const float theta = std::atan2(w.dot(target), source.dot(target));
  const float alpha = v.dot(target);
  constexpr float kInverseTwoPi = 0.15915494f;
  histogram[static_cast<std::size_t>(bin_of(theta * kInverseTwoPi + 0.5f))] += 1;
  histogram[static_cast<std::size_t>(kBins + bin_of(0.5f * (alpha + 1)))] += 1;
  histogram[static_cast<std::size_t>(2 * kBins + bin_of(0.5f * (phi + 1)))] += 1;
  return true;
}

Fpfh simplified(const PointCloud& cloud, const NeighborGrid& grid, std::size_t i) {
  Fpfh histogram{};
  int pairs = 0;
  grid.for_each_neighbor(cloud.points[i], [&](int other, float) {
    const auto j = static_cast<std::size_t>(other);
    if (j == i) return;
    pairs +=
        add_pair(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j], histogram);
  });
  if (pairs > 0) {
    for (float& value : histogram) value *= 100.0f / static_cast<float>(pairs);
  }
  return histogram;
}

void normalize(Fpfh& histogram) {
  for (int part = 0; part < 3; ++part) {
    float sum = 0;
    for (int k = 0; k < kBins; ++k) sum += histogram[static_cast<std::size_t>(part * kBins + k)];
    if (sum <= 0) continue;
    for (int k = 0; k < kBins; ++k) {
      histogram[static_cast<std::size_t>(part * kBins + k)] *= 100 / sum;
    }
  }
}

}  // namespace

std::vector<Fpfh> compute_fpfh(const PointCloud& cloud, std::span<const int> indices, float radius,
                               int num_threads) {
  const NeighborGrid grid(cloud.points, radius);
  std::vector<std::uint8_t> needed(cloud.size(), 0);
  for (int index : indices) {
    grid.for_each_neighbor(cloud.points[static_cast<std::size_t>(index)],
                           [&](int j, float) { needed[static_cast<std::size_t>(j)] = 1; });
  }
  std::vector<Fpfh> histograms(cloud.size());
  parallel_for(
      static_cast<int>(cloud.size()), num_threads,
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        if (needed[k]) histograms[k] = simplified(cloud, grid, k);
      },
      64);

  std::vector<Fpfh> features(indices.size());
  parallel_for(
      static_cast<int>(indices.size()), num_threads,
      [&](int k) {
        const auto i = static_cast<std::size_t>(indices[static_cast<std::size_t>(k)]);
        Fpfh feature{};
        grid.for_each_neighbor(cloud.points[i], [&](int j, float squared) {
          const Fpfh& other = histograms[static_cast<std::size_t>(j)];
          if (squared <= 0) return;
          const float weight = 1 / std::sqrt(squared);
          for (std::size_t b = 0; b < feature.size(); ++b) feature[b] += weight * other[b];
        });
        normalize(feature);
        for (std::size_t b = 0; b < feature.size(); ++b) feature[b] += histograms[i][b];
        normalize(feature);
        features[static_cast<std::size_t>(k)] = feature;
      },
      64);
  return features;
}

}  // namespace bpa
