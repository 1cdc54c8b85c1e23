// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/segment/pixel_features.hpp"

namespace bpa::detail {
namespace {

constexpr int kRowsPerPiece = 8;
// What half a spacing off the cell's middle costs a first centre, in edge likelihood; by hand.
constexpr float kOffCentreCost = 0.5f;

struct Centre {
  PixelFeature mean;  ///< Not valid() for a centre without pixels.
  float inverse_spacing_squared = 0;
  int u = 0, v = 0;  ///< Where it is in the image.
};

class KMeans {
 public:
  KMeans(const SurfaceMap& map, const PixelFeatures& features, const Image<float>& edges,
         const SuperPixelOptions& options)
      : map_(map),
        features_(features),
        edges_(edges),
        options_(options),
        spacing_(options.spacing_px),
        columns_((map.width() + spacing_ - 1) / spacing_),
        rows_((map.height() + spacing_ - 1) / spacing_),
        edge_weight_(static_cast<float>(1 / (options.edge * options.edge))),
        centres_(static_cast<std::size_t>(columns_ * rows_)),
        labels_(map.width(), map.height(), -1) {}

  Image<std::int32_t> run() {
    parallel_for(
        columns_ * rows_, options_.num_threads, [&](int k) { place(k); }, 32);
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
      parallel_for(
          map_.height(), options_.num_threads, [&](int v) { assign_row(v); }, kRowsPerPiece);
      if (iteration + 1 == options_.iterations) break;
      parallel_for(
          columns_ * rows_, options_.num_threads, [&](int k) { update(k); }, 32);
    }
    return std::move(labels_);
  }

 private:
  // The first centre of a cell: its pixel of the least edge likelihood, of those the most central.
  void place(int k) {
    const int u0 = k % columns_ * spacing_, v0 = k / columns_ * spacing_;
    const float middle_u = static_cast<float>(u0) + 0.5f * static_cast<float>(spacing_ - 1);
    const float middle_v = static_cast<float>(v0) + 0.5f * static_cast<float>(spacing_ - 1);
    float best = std::numeric_limits<float>::max();
    for (int v = v0; v < std::min(v0 + spacing_, map_.height()); ++v) {
      for (int u = u0; u < std::min(u0 + spacing_, map_.width()); ++u) {
        const std::size_t i = edges_.index(u, v);
        if (!features_[i].valid()) continue;
        const float off = std::hypot(static_cast<float>(u) - middle_u,  //
                                     static_cast<float>(v) - middle_v);
        const float cost = edges_[i] + kOffCentreCost * off / static_cast<float>(spacing_);
        if (cost >= best) continue;
        best = cost;
        set(centres_[static_cast<std::size_t>(k)], features_[i], u, v);
      }
    }
  }

  void set(Centre& centre, const PixelFeature& mean, int u, int v) const {
    centre.mean = mean;
    centre.inverse_spacing_squared = inverse_spacing_squared(map_, options_, mean.position.z());
    centre.u = u;
    centre.v = v;
  }

  // The largest edge likelihood at three places between a pixel and a centre. The edge image is
  // blurred, so that no line of it slips through.
  float edge_between(int u, int v, const Centre& centre) const {
    const int du = centre.u - u, dv = centre.v - v;
    const auto at = [&](int quarter) {
      return edges_.at(u + (quarter * du + 2) / 4, v + (quarter * dv + 2) / 4);
    };
    return std::max({at(1), at(2), at(3)});
  }

  // Looks at one centre for pixel i; whether it is nearer than `best`, which it then becomes.
  bool improves(std::size_t i, int u, int v, int k, float& best) const {
    const Centre& centre = centres_[static_cast<std::size_t>(k)];
    if (!centre.mean.valid()) return false;
    float far = distance(features_[i], centre.mean, centre.inverse_spacing_squared);
    if (far >= best) return false;
    const float edge = edge_between(u, v, centre);
    far += edge_weight_ * edge * edge;
    if (far >= best) return false;
    best = far;
    return true;
  }

  void assign_row(int v) {
    const int row = v / spacing_;
    for (int u = 0; u < map_.width(); ++u) {
      const std::size_t i = edges_.index(u, v);
      if (!features_[i].valid()) continue;
      const int column = u / spacing_;
      // The centre of the last round first: it is mostly the nearest, and spares the others' edges.
      const int likely = labels_[i] >= 0 ? labels_[i] : row * columns_ + column;
      float best = std::numeric_limits<float>::max();
      if (improves(i, u, v, likely, best)) labels_[i] = likely;
      for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
          const int k = y * columns_ + x;
          if (k != likely && improves(i, u, v, k, best)) labels_[i] = k;
        }
      }
    }
  }

  // The mean of the centre's pixels; they are all in the nine cells about it. An empty centre stays
  // where it is.
  void update(int k) {
    const int u0 = (k % columns_ - 1) * spacing_, v0 = (k / columns_ - 1) * spacing_;
    PixelFeature sum;
    int sum_u = 0, sum_v = 0, count = 0;
    for (int v = std::max(0, v0); v < std::min(v0 + 3 * spacing_, map_.height()); ++v) {
      for (int u = std::max(0, u0); u < std::min(u0 + 3 * spacing_, map_.width()); ++u) {
        const std::size_t i = edges_.index(u, v);
        if (labels_[i] != k) continue;
        sum.position += features_[i].position;
        sum.normal += features_[i].normal;
        sum.color += features_[i].color;
        sum_u += u, sum_v += v, ++count;
      }
    }
    if (count == 0) return;
    const float share = 1 / static_cast<float>(count);
    const PixelFeature mean{share * sum.position, share * sum.normal, share * sum.color};
    set(centres_[static_cast<std::size_t>(k)], mean, sum_u / count, sum_v / count);
  }

  const SurfaceMap& map_;
  const PixelFeatures& features_;
  const Image<float>& edges_;
  const SuperPixelOptions& options_;
  const int spacing_, columns_, rows_;
  const float edge_weight_;
  std::vector<Centre> centres_;
  Image<std::int32_t> labels_;
};

}  // namespace

Image<std::int32_t> cluster(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const SuperPixelOptions& options) {
  return KMeans(map, features, edges, options).run();
}

}  // namespace bpa::detail
