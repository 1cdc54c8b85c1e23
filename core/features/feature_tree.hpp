// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/features/fpfh.hpp"

namespace bpa {

/// Exact nearest neighbours among feature histograms: one FLANN kd-tree. Safe to query from
/// several threads.
class FeatureTree {
 public:
  /// Keeps a copy of the features.
  explicit FeatureTree(std::span<const Fpfh> features);
  ~FeatureTree();
  FeatureTree(FeatureTree&&) noexcept;
  FeatureTree& operator=(FeatureTree&&) noexcept;

  struct Match {
    int index = -1;
    float squared_distance = 0;
  };
  /// The `count` nearest features of each query, nearest first: matches[q * count + k]. Index -1
  /// where the tree holds fewer.
  std::vector<Match> nearest(std::span<const Fpfh> queries, int count, int num_threads) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bpa
