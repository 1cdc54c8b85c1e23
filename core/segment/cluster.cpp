// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/segment/pixel_features.hpp"

namespace bpa::segment::detail {
namespace {

// What half a spacing off the cell's middle costs a first centre, in edge likelihood; by hand.
constexpr float kOffCentreCost = 0.5f;

struct Centre {
  PixelFeature mean;  ///< Not valid() for a centre without pixels.
  float inverse_spacing_squared = 0;
  int u = 0, v = 0;  ///< Where it is in the image.
};

struct KMeans {
  const SurfaceMap& map;
  const PixelFeatures& features;
  const Image<float>& edges;
  const SuperPixelOptions& options;
  const int spacing = options.spacing_px;
  const int columns = (map.width() + spacing - 1) / spacing;
  const int rows = (map.height() + spacing - 1) / spacing;
  const float edge_weight = static_cast<float>(1 / (options.edge * options.edge));
  std::vector<Centre> centres = std::vector<Centre>(columns * rows);
  Image<std::int32_t> labels{map.width(), map.height(), -1};

  Image<std::int32_t> run() {
    const int threads = options.num_threads;
    parallel_for(columns * rows, threads, [&](int k) { place(k); });
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      if (iteration > 0) parallel_for(columns * rows, threads, [&](int k) { update(k); });
      parallel_for(map.height(), threads, [&](int v) { assign_row(v); });
    }
    return std::move(labels);
  }

  // The first centre of a cell: its pixel of the least edge likelihood, of those the most central.
  void place(int k) {
    const int u0 = k % columns * spacing, v0 = k / columns * spacing;
    const float middle_u = static_cast<float>(u0) + 0.5f * static_cast<float>(spacing - 1);
    const float middle_v = static_cast<float>(v0) + 0.5f * static_cast<float>(spacing - 1);
    float best = std::numeric_limits<float>::max();
    for (int v = v0; v < std::min(v0 + spacing, map.height()); ++v) {
      for (int u = u0; u < std::min(u0 + spacing, map.width()); ++u) {
        const int i = edges.index(u, v);
        if (!features[i].valid()) continue;
        const float off = std::hypot(static_cast<float>(u) - middle_u,  //
                                     static_cast<float>(v) - middle_v);
        const float cost = edges[i] + kOffCentreCost * off / static_cast<float>(spacing);
        if (cost >= best) continue;
        best = cost;
        set(centres[k], features[i], u, v);
      }
    }
  }

  void set(Centre& centre, const PixelFeature& mean, int u, int v) const {
    centre.mean = mean;
    centre.inverse_spacing_squared = inverse_spacing_squared(map, options, mean.position.z());
    centre.u = u;
    centre.v = v;
  }

  // The largest edge likelihood at three places between a pixel and a centre. The edge image is
  // blurred, so that no line of it slips through.
  float edge_between(int u, int v, const Centre& centre) const {
    const int du = centre.u - u, dv = centre.v - v;
    const auto at = [&](int quarter) {
      return edges.at(u + (quarter * du + 2) / 4, v + (quarter * dv + 2) / 4);
    };
    return std::max({at(1), at(2), at(3)});
  }

  // Looks at one centre for pixel i; whether it is nearer than `best`, which it then becomes.
  bool improves(std::size_t i, int u, int v, int k, float& best) const {
    const Centre& centre = centres[k];
    if (!centre.mean.valid()) return false;
    float far = distance(features[i], centre.mean, centre.inverse_spacing_squared);
    if (far >= best) return false;
    const float edge = edge_between(u, v, centre);
    far += edge_weight * edge * edge;
    if (far >= best) return false;
    best = far;
    return true;
  }

  void assign_row(int v) {
    const int row = v / spacing;
    for (int u = 0; u < map.width(); ++u) {
      const int i = edges.index(u, v);
      if (!features[i].valid()) continue;
      const int column = u / spacing;
      // The centre of the last round first: it is mostly the nearest, and spares the others' edges.
      const int likely = labels[i] >= 0 ? labels[i] : row * columns + column;
      float best = std::numeric_limits<float>::max();
      if (improves(i, u, v, likely, best)) labels[i] = likely;
      for (int y = std::max(0, row - 1); y <= std::min(rows - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
          const int k = y * columns + x;
          if (k != likely && improves(i, u, v, k, best)) labels[i] = k;
        }
      }
    }
  }

  // The mean of the centre's pixels; they are all in the nine cells about it. An empty centre stays
  // where it is.
  void update(int k) {
    const int u0 = (k % columns - 1) * spacing, v0 = (k / columns - 1) * spacing;
    PixelFeature sum;
    int sum_u = 0, sum_v = 0, count = 0;
    for (int v = std::max(0, v0); v < std::min(v0 + 3 * spacing, map.height()); ++v) {
      for (int u = std::max(0, u0); u < std::min(u0 + 3 * spacing, map.width()); ++u) {
        const int i = edges.index(u, v);
        if (labels[i] != k) continue;
        sum.position += features[i].position;
        sum.normal += features[i].normal;
        sum.color += features[i].color;
        sum_u += u, sum_v += v, ++count;
      }
    }
    if (count == 0) return;
    const float share = 1 / static_cast<float>(count);
    const PixelFeature mean{share * sum.position, share * sum.normal, share * sum.color};
    set(centres[k], mean, sum_u / count, sum_v / count);
  }
};

}  // namespace

PixelFeatures pixel_features(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                             const SuperPixelOptions& options) {
  const auto normal_scale =
      static_cast<float>(1 / (2 * std::sin(0.5 * options.angle_deg * M_PI / 180)));
  const auto color_scale = static_cast<float>(1 / options.color);
  PixelFeatures features(map.size());
  parallel_for(map.size(), options.num_threads, [&](std::size_t i) {
    if (map.depth[i] <= 0 || map.normals[i].squaredNorm() == 0) return;
    features[i].position << map.points[i], 1;
    features[i].normal << normal_scale * map.normals[i], 0;
    if (!lab.empty()) features[i].color << color_scale * lab[i], 0;
  });
  return features;
}

float inverse_spacing_squared(const SurfaceMap& map, const SuperPixelOptions& options, float z) {
  const float spacing = static_cast<float>(options.spacing_px / map.camera.fx) * z;
  return 1 / (spacing * spacing);
}

Image<std::int32_t> cluster(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const SuperPixelOptions& options) {
  return KMeans{map, features, edges, options}.run();
}

}  // namespace bpa::segment::detail
