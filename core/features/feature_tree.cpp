// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/feature_tree.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

namespace bpa {

struct FeatureTree::Impl {
  using Index = flann::KDTreeSingleIndex<flann::L2<float>>;

  explicit Impl(std::span<const Fpfh> features)
      : data(features.begin(), features.end()),
        index(flann::Matrix<float>(data.empty() ? nullptr : data.front().data(), data.size(), 33),
              flann::KDTreeSingleIndexParams(15)) {
    if (!data.empty()) index.buildIndex();
  }

  std::vector<Fpfh> data;
  mutable Index index;  // queries are const in fact, not in FLANN's signature
};

FeatureTree::FeatureTree(std::span<const Fpfh> features) : impl_(new Impl(features)) {}
FeatureTree::~FeatureTree() = default;
FeatureTree::FeatureTree(FeatureTree&&) noexcept = default;
FeatureTree& FeatureTree::operator=(FeatureTree&&) noexcept = default;

std::vector<FeatureTree::Match> FeatureTree::nearest(std::span<const Fpfh> queries, int count,
                                                     int num_threads) const {
  const auto per_query = static_cast<std::size_t>(count);
  std::vector<Match> matches(queries.size() * per_query);
  const std::size_t available = std::min(per_query, impl_->data.size());
  if (available == 0) return matches;
  parallel_for_pieces(
      static_cast<int>(queries.size()), 64, num_threads, [&](int first, int last, int) {
        const auto rows = static_cast<std::size_t>(last - first);
        std::vector<Fpfh> piece(queries.begin() + first, queries.begin() + last);
        std::vector<std::size_t> indices(rows * available);
        std::vector<float> distances(rows * available);
        flann::Matrix<std::size_t> index_matrix(indices.data(), rows, available);
        flann::Matrix<float> distance_matrix(distances.data(), rows, available);
        flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED);
        exact.cores = 1;
        impl_->index.knnSearch(flann::Matrix<float>(piece.front().data(), rows, 33), index_matrix,
                               distance_matrix, available, exact);
        for (std::size_t q = 0; q < rows; ++q) {
          for (std::size_t k = 0; k < available; ++k) {
            matches[(static_cast<std::size_t>(first) + q) * per_query + k] = {
                static_cast<int>(indices[q * available + k]), distances[q * available + k]};
          }
        }
      });
  return matches;
}

}  // namespace bpa
