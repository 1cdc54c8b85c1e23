// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/blur.hpp"
#include "core/cloud/cielab.hpp"
#include "core/doctor/frame_check.hpp"
#include "core/features/edges.hpp"

namespace bpa::doctor {
namespace {

// What is looked through, in pixels of the surface map. A Kinect's cameras are 25 mm and 10 % of
// the focal length apart: 16 pixels and a scale of 0.9 at 0.4 m.
constexpr int kMaxRight = 40;
constexpr int kMaxDown = 20;
constexpr double kScales[] = {0.88, 0.91, 0.94, 0.97, 1, 1.03, 1.06, 1.09, 1.12};

constexpr std::size_t kMinEdges = 300;  // fewer fit somewhere by chance; chosen by hand
constexpr double kMinInside = 0.7;  // share of the depth edges that an offset keeps in the image
constexpr double kBlur = 1.0;       // map pixels that a Kinect's depth edges are off by

struct Edges {
  std::vector<Eigen::Vector2f> depth;  ///< Map pixels from the centre of the image.
  Image<float> color;                  ///< 1 on an edge, less beside it.
};

Edges edges_of(const Frame& frame, int num_threads) {
  SurfaceMapOptions map_options;
  map_options.num_threads = num_threads;
  const SurfaceMap map = surface_map(frame, map_options);
  features::ImageEdgeOptions image_options;
  image_options.num_threads = num_threads;
  const Image<std::uint8_t> lines =
      features::image_edges(reduced_color(frame, map, num_threads), image_options);
  Edges edges{{}, {lines.width, lines.height, 0.0f}};
  const float unit = 1 / blurred_line_peak(kBlur);
  for (std::size_t i = 0; i < lines.size(); ++i) edges.color[i] = unit * lines[i];
  edges.color = blur(edges.color, kBlur, num_threads);
  for (float& value : edges.color.pixels) value = std::min(1.0f, value);
  features::RangeEdgeOptions range_options;
  range_options.num_threads = num_threads;
  const Image<features::RangeEdge> range = features::range_edges(map, range_options);
  for (int v = 0; v < range.height; ++v) {
    for (int u = 0; u < range.width; ++u) {
      if (range.at(u, v) != features::RangeEdge::occluding) continue;
      edges.depth.emplace_back(static_cast<float>(u) - 0.5f * static_cast<float>(range.width - 1),
                               static_cast<float>(v) - 0.5f * static_cast<float>(range.height - 1));
    }
  }
  return edges;
}

/// The mean of the colour edges at the depth edges; NaN where too many leave the image.
double agreement(const Edges& edges, int right, int down, double scale) {
  const Image<float>& color = edges.color;
  const auto factor = static_cast<float>(scale);
  const float u0 = 0.5f * static_cast<float>(color.width) + static_cast<float>(right);
  const float v0 = 0.5f * static_cast<float>(color.height) + static_cast<float>(down);
  double sum = 0;
  std::size_t inside = 0;
  for (const Eigen::Vector2f& p : edges.depth) {
    const int u = static_cast<int>(std::floor(u0 + factor * p.x()));
    const int v = static_cast<int>(std::floor(v0 + factor * p.y()));
    if (!color.contains(u, v)) continue;
    ++inside;
    sum += static_cast<double>(color.at(u, v));
  }
  const bool enough =
      static_cast<double>(inside) >= kMinInside * static_cast<double>(edges.depth.size());
  return enough ? sum / static_cast<double>(inside) : std::nan("");
}

/// All offsets of one scale: the best, the sum of the agreements and their number.
struct OfOneScale {
  EdgeOffset best;
  double sum = 0;
  double count = 0;
};

OfOneScale search_scale(const Edges& edges, double scale) {
  OfOneScale out;
  for (int down = -kMaxDown; down <= kMaxDown; ++down) {
    for (int right = -kMaxRight; right <= kMaxRight; ++right) {
      const double value = agreement(edges, right, down, scale);
      if (std::isnan(value)) continue;
      out.sum += value;
      ++out.count;
      if (value <= out.best.agreement) continue;
      out.best.right = right;
      out.best.down = down;
      out.best.scale = scale;
      out.best.agreement = value;
    }
  }
  return out;
}

}  // namespace

std::optional<EdgeOffset> find_edge_offset(const Frame& frame, int num_threads) {
  if (frame.color.empty()) return std::nullopt;
  const Edges edges = edges_of(frame, num_threads);
  if (edges.depth.size() < kMinEdges) return std::nullopt;
  std::vector<OfOneScale> found(std::size(kScales));
  parallel_for(static_cast<int>(found.size()), num_threads,
               [&](int i) { found[i] = search_scale(edges, kScales[i]); });
  EdgeOffset best;
  double sum = 0, count = 0;
  for (const OfOneScale& one : found) {
    sum += one.sum;
    count += one.count;
    if (one.best.agreement > best.agreement) best = one.best;
  }
  best.agreement_now = agreement(edges, 0, 0, 1);
  best.agreement_chance = sum / count;
  const double per_map_pixel = static_cast<double>(frame.camera.width) / edges.color.width;
  for (const Eigen::Vector2f& p : edges.depth) {
    const Eigen::Vector2d moved =
        (best.scale - 1) * p.cast<double>() + Eigen::Vector2d(best.right, best.down);
    best.pixels += per_map_pixel * moved.norm() / static_cast<double>(edges.depth.size());
  }
  best.right *= per_map_pixel;
  best.down *= per_map_pixel;
  return best;
}

}  // namespace bpa::doctor
