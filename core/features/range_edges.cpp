// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/range_edges.hpp"

#include "core/base/parallel.hpp"
#include "core/cloud/surface_break.hpp"

namespace bpa {
namespace {

constexpr int kSteps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

// The next pixel with a depth from (u, v) along a step; -1 when there is none within the gap.
int next_valid(const SurfaceMap& map, int u, int v, const int (&step)[2], int max_gap) {
  for (int k = 1; k <= max_gap + 1; ++k) {
    const int x = u + k * step[0], y = v + k * step[1];
    if (x < 0 || y < 0 || x >= map.width() || y >= map.height()) return -1;
    const int index = y * map.width() + x;
    if (map.depth[static_cast<std::size_t>(index)] > 0) return index;
  }
  return -1;
}

RangeEdge classify(const SurfaceMap& map, int u, int v, int max_gap) {
  const auto here = static_cast<std::size_t>(v * map.width() + u);
  if (map.depth[here] <= 0) return RangeEdge::none;
  RangeEdge edge = RangeEdge::none;
  for (const auto& step : kSteps) {
    const int next = next_valid(map, u, v, step, max_gap);
    if (next < 0) continue;
    const auto there = static_cast<std::size_t>(next);
    if (!surface_breaks(map, here, there)) continue;
    if (map.depth[here] < map.depth[there]) return RangeEdge::occluding;
    edge = RangeEdge::occluded;
  }
  return edge;
}

}  // namespace

Image<RangeEdge> range_edges(const SurfaceMap& map, const RangeEdgeOptions& options) {
  Image<RangeEdge> edges(map.width(), map.height(), RangeEdge::none);
  parallel_for(
      edges.height, options.num_threads,
      [&](int v) {
        for (int u = 0; u < edges.width; ++u) {
          edges.at(u, v) = classify(map, u, v, options.max_gap_px);
        }
      },
      8);
  return edges;
}

}  // namespace bpa
