// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/curvature_edges.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/cloud/surface_break.hpp"

namespace bpa {
namespace {

// Pixels to either side that span the baseline on a surface seen from the front.
int baseline_px(const SurfaceMap& map, float z, const CurvatureEdgeOptions& options) {
  const double pixels = options.baseline_m * map.camera.fx / static_cast<double>(z);
  return static_cast<int>(std::lround(std::clamp(pixels, 1.0, options.max_baseline_px)));
}

bool usable(const SurfaceMap& map, std::size_t centre, int u, int v, std::size_t& index) {
  if (u < 0 || v < 0 || u >= map.width() || v >= map.height()) return false;
  index = static_cast<std::size_t>(v * map.width() + u);
  return map.depth[index] > 0 && map.normals[index].squaredNorm() > 0 &&
         !surface_breaks(map, centre, index);
}

void fill_pixel(const SurfaceMap& map, int u, int v, const CurvatureEdgeOptions& options,
                HollowMap& out) {
  const auto centre = static_cast<std::size_t>(v * map.width() + u);
  if (map.depth[centre] <= 0 || map.normals[centre].squaredNorm() == 0) return;
  const int reach = baseline_px(map, map.depth[centre], options);
  bool known = false;
  for (std::uint8_t d = 0; d < 4; ++d) {
    const bool diagonal = d % 2 == 1;
    const int steps = diagonal ? std::max(1, (reach * 5 + 3) / 7) : reach;  // over sqrt(2)
    const int du = steps * kHollowDirections[d][0], dv = steps * kHollowDirections[d][1];
    std::size_t one = 0, other = 0;
    if (!usable(map, centre, u + du, v + dv, one)) continue;
    if (!usable(map, centre, u - du, v - dv, other)) continue;
    const Eigen::Vector3f chord = map.points[one] - map.points[other];
    const float bend = (map.normals[one] - map.normals[other]).dot(chord) / chord.squaredNorm();
    if (known && bend >= out.curvature[centre]) continue;
    known = true;
    out.curvature[centre] = bend;
    out.direction[centre] = d;
  }
}

float curvature_at(const HollowMap& map, int u, int v) {
  return map.curvature.contains(u, v) ? map.curvature.at(u, v) : 0;
}

// Of equal neighbours the later one is the bottom.
bool is_bottom(const HollowMap& map, int u, int v) {
  const auto& step = kHollowDirections[map.direction.at(u, v)];
  const float here = map.curvature.at(u, v);
  return here < curvature_at(map, u + step[0], v + step[1]) &&
         here <= curvature_at(map, u - step[0], v - step[1]);
}

}  // namespace

HollowMap hollow_map(const SurfaceMap& map, const CurvatureEdgeOptions& options) {
  HollowMap out{{map.width(), map.height(), 0.0f}, {map.width(), map.height(), std::uint8_t{0}}};
  parallel_for(
      map.height(), options.num_threads,
      [&](int v) {
        for (int u = 0; u < map.width(); ++u) fill_pixel(map, u, v, options, out);
      },
      8);
  return out;
}

Image<std::uint8_t> curvature_edges(const SurfaceMap& map, const CurvatureEdgeOptions& options) {
  const HollowMap hollow = hollow_map(map, options);
  Image<std::uint8_t> edges(map.width(), map.height(), 0);
  const auto limit = static_cast<float>(-options.min_concavity);
  for (int v = 0; v < edges.height; ++v) {
    for (int u = 0; u < edges.width; ++u) {
      edges.at(u, v) = hollow.curvature.at(u, v) < limit && is_bottom(hollow, u, v);
    }
  }
  return edges;
}

}  // namespace bpa
