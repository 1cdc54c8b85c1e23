// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa::features {

/// Fast point feature histogram: three histograms of 11 bins, each summing to 100.
using Fpfh = std::array<float, 33>;

/// Fast point feature histograms (Rusu, Blodow and Beetz, ICRA 2009) of the points `indices`, over
/// neighbours within `radius`. The cloud needs normals. Evenly spaced points make features of scene
/// and model comparable. Simplified histograms are computed once for every point that needs one.
std::vector<Fpfh> compute_fpfh(const PointCloud& cloud, std::span<const int> indices, float radius,
                               int num_threads);

/// Exact nearest neighbours among feature histograms: one FLANN kd-tree. Safe to query from
/// several threads. Copies share the tree.
class FeatureTree {
 public:
  /// Keeps a copy of the features.
  explicit FeatureTree(std::span<const Fpfh> features);

  struct Match {
    int index = -1;
    float squared_distance = 0;
  };
  /// The `count` nearest features of each query, nearest first: matches[q * count + k]. Index -1
  /// where the tree holds fewer.
  std::vector<Match> nearest(std::span<const Fpfh> queries, int count, int num_threads) const;

 private:
  struct Index;
  std::shared_ptr<const Index> index_;
};

}  // namespace bpa::features
