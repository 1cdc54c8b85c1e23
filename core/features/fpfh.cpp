// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/fpfh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

namespace bpa::features {
namespace {

constexpr int kBins = 11;

int bin_of(float unit) { return std::clamp(static_cast<int>(unit * kBins), 0, kBins - 1); }

int bin_of_angle(float radians) {
  constexpr float kInverseTwoPi = 0.15915494f;
  return bin_of(radians * kInverseTwoPi + 0.5f);
}

// bin_of_angle(std::atan2(y, x)), mostly without a call of it.
int bin_of_direction(float y, float x) {
  constexpr float kPi = 3.14159265f;
  constexpr float kBend = 0.273f;    // of atan(t) = t (pi/4 + kBend (1 - t)), to 0.004 radians
  constexpr float kMargin = 0.006f;  // radians
  const float across = std::abs(x), up = std::abs(y);
  const float t = std::min(across, up) / std::max(across, up);
  float angle = t * (0.25f * kPi + kBend * (1 - t));
  if (up > across) angle = 0.5f * kPi - angle;
  if (x < 0) angle = kPi - angle;
  if (y < 0) angle = -angle;
  const int bin = bin_of_angle(angle - kMargin);
  const bool sure = bin == bin_of_angle(angle + kMargin);  // not where t is no number
  return sure ? bin : bin_of_angle(std::atan2(y, x));
}

// The bins of a pair's three angles; none where its frame is undefined.
struct PairBins {
  int theta = -1, alpha = 0, phi = 0;

  bool defined() const { return theta >= 0; }
  void add_to(Fpfh& histogram) const {
    if (!defined()) return;
    histogram[theta] += 1;
    histogram[kBins + alpha] += 1;
    histogram[2 * kBins + phi] += 1;
  }
};

// In the Darboux frame of the point whose normal is better aligned with the line between them.
// `even`: both are aligned alike; otherwise the pair the other way round has the same bins.
PairBins bins_of_pair(const Eigen::Vector3f& p, const Eigen::Vector3f& np, const Eigen::Vector3f& q,
                      const Eigen::Vector3f& nq, bool& even) {
  even = false;
  Eigen::Vector3f line = q - p;
  const float distance = line.norm();
  if (distance < 1e-6f) return {};
  line /= distance;
  const float cosine_p = np.dot(line);
  const float cosine_q = nq.dot(line);
  const bool swap = std::abs(cosine_p) < std::abs(cosine_q);
  even = std::abs(cosine_p) == std::abs(cosine_q);
  const Eigen::Vector3f& source = swap ? nq : np;
  const Eigen::Vector3f& target = swap ? np : nq;
  const float phi = swap ? -cosine_q : cosine_p;
  Eigen::Vector3f v = (swap ? Eigen::Vector3f(-line) : line).cross(source);
  const float v_norm = v.norm();
  if (v_norm < 1e-6f) return {};
  v /= v_norm;
  const Eigen::Vector3f w = source.cross(v);
  const float alpha = v.dot(target);
  return {bin_of_direction(w.dot(target), source.dot(target)), bin_of(0.5f * (alpha + 1)),
          bin_of(0.5f * (phi + 1))};
}

// The simplified histograms of the points that are `needed`. Each pair is measured once; threads
// count apart.
std::vector<Fpfh> simplified(const PointCloud& cloud, const NeighborGrid& grid,
                             const std::vector<std::uint8_t>& needed, int num_threads) {
  const int threads = resolve_num_threads(num_threads);
  std::vector<std::vector<Fpfh>> counts(threads);
  const auto count_pairs = [&](int first, int last, int thread) {
    std::vector<Fpfh>& own = counts[thread];
    if (own.empty()) own.resize(cloud.size());
    const auto bins = [&](int a, int b, bool& even) {
      return bins_of_pair(cloud.points[a], cloud.normals[a], cloud.points[b], cloud.normals[b],
                          even);
    };
    for (int i = first; i < last; ++i) {
      grid.for_each_neighbor(cloud.points[i], [&](int j, float) {
        if (j <= i || !(needed[i] || needed[j])) return;
        bool even = false;
        const PairBins pair = bins(i, j, even);
        pair.add_to(own[i]);
        (even ? bins(j, i, even) : pair).add_to(own[j]);
      });
    }
  };
  constexpr int kPiece = 64;  // points
  parallel_for_pieces(static_cast<int>(cloud.size()), kPiece, num_threads, count_pairs);
  std::vector<Fpfh> histograms(cloud.size());
  parallel_for(cloud.size(), num_threads, [&](std::size_t i) {
    Fpfh& histogram = histograms[i];
    for (const std::vector<Fpfh>& of_thread : counts) {
      if (of_thread.empty()) continue;
      for (std::size_t b = 0; b < histogram.size(); ++b) histogram[b] += of_thread[i][b];
    }
    const float pairs = std::accumulate(histogram.begin(), histogram.begin() + kBins, 0.0f);
    if (pairs > 0) {
      for (float& value : histogram) value *= 100.0f / pairs;
    }
  });
  return histograms;
}

void normalize(Fpfh& histogram) {
  for (auto part = histogram.begin(); part != histogram.end(); part += kBins) {
    const float sum = std::accumulate(part, part + kBins, 0.0f);
    if (sum <= 0) continue;
    std::for_each(part, part + kBins, [sum](float& value) { value *= 100 / sum; });
  }
}

}  // namespace

std::vector<Fpfh> compute_fpfh(const PointCloud& cloud, std::span<const int> indices, float radius,
                               int num_threads) {
  const NeighborGrid grid(cloud.points, radius);
  std::vector<std::uint8_t> needed(cloud.size(), 0);
  for (const int index : indices) {
    grid.for_each_neighbor(cloud.points[index], [&](int j, float) { needed[j] = 1; });
  }
  const std::vector<Fpfh> histograms = simplified(cloud, grid, needed, num_threads);
  std::vector<Fpfh> features(indices.size());
  parallel_for(indices.size(), num_threads, [&](std::size_t k) {
    const int i = indices[k];
    Fpfh& feature = features[k];
    grid.for_each_neighbor(cloud.points[i], [&](int j, float squared) {
      if (squared <= 0) return;
      const float weight = 1 / std::sqrt(squared);
      for (std::size_t b = 0; b < feature.size(); ++b) feature[b] += weight * histograms[j][b];
    });
    normalize(feature);
    for (std::size_t b = 0; b < feature.size(); ++b) feature[b] += histograms[i][b];
    normalize(feature);
  });
  return features;
}

struct FeatureTree::Index {
  using Tree = flann::KDTreeSingleIndex<flann::L2<float>>;

  explicit Index(std::span<const Fpfh> features)
      : data(features.begin(), features.end()),
        tree(flann::Matrix<float>(data.empty() ? nullptr : data.front().data(), data.size(), 33),
             flann::KDTreeSingleIndexParams(15)) {
    if (!data.empty()) tree.buildIndex();
  }

  std::vector<Fpfh> data;
  mutable Tree tree;  // queries are const in fact, not in FLANN's signature
};

FeatureTree::FeatureTree(std::span<const Fpfh> features)
    : index_(std::make_shared<const Index>(features)) {}

std::vector<FeatureTree::Match> FeatureTree::nearest(std::span<const Fpfh> queries, int count,
                                                     int num_threads) const {
  const auto per_query = static_cast<std::size_t>(count);
  std::vector<Match> matches(queries.size() * per_query);
  const std::size_t available = std::min(per_query, index_->data.size());
  if (available == 0) return matches;
  const auto match_piece = [&](int first, int last, int) {
    const std::size_t rows = last - first;
    std::vector<Fpfh> piece(queries.begin() + first, queries.begin() + last);
    std::vector<std::size_t> indices(rows * available);
    std::vector<float> distances(rows * available);
    flann::Matrix<std::size_t> index_matrix(indices.data(), rows, available);
    flann::Matrix<float> distance_matrix(distances.data(), rows, available);
    flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED);
    exact.cores = 1;
    index_->tree.knnSearch(flann::Matrix<float>(piece.front().data(), rows, 33), index_matrix,
                           distance_matrix, available, exact);
    for (std::size_t q = 0; q < rows; ++q) {
      for (std::size_t k = 0; k < available; ++k) {
        matches[(first + q) * per_query + k] = {static_cast<int>(index_matrix[q][k]),
                                                distance_matrix[q][k]};
      }
    }
  };
  parallel_for_pieces(static_cast<int>(queries.size()), 64, num_threads, match_piece);
  return matches;
}

}  // namespace bpa::features
