// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/geometry/camera.hpp"

namespace bpa::camera {
namespace {

/// A corner of a depth pixel's square as a pixel of the colour image.
Eigen::Vector2d carried(const DeviceGeometry& g, double u, double v, double z) {
  const double x = (u - g.depth.cx) / g.depth.fx - g.baseline / z;
  const double y = (v - g.depth.cy) / g.depth.fy;
  const Eigen::Vector2d seen =
      g.color_distortion.empty() ? Eigen::Vector2d(x, y) : distort(g.color_distortion, x, y);
  return {g.color.fx * seen.x() + g.color.cx, g.color.fy * seen.y() + g.color.cy};
}

void close_gaps(const Camera& camera, std::vector<std::uint16_t>& depth) {
  const auto one_surface = [](int a, int b) { return 50 * std::abs(a - b) <= std::min(a, b); };
  for (int v = 0; v < camera.height; ++v) {
    std::uint16_t* row = depth.data() + v * camera.width;
    for (int u = 1; u + 1 < camera.width; ++u) {
      if (row[u] != 0 || row[u - 1] == 0 || row[u + 1] == 0) continue;
      if (!one_surface(row[u - 1], row[u + 1])) continue;
      row[u] = static_cast<std::uint16_t>((row[u - 1] + row[u + 1]) / 2);
      ++u;  // a filled pixel fills no other
    }
  }
}

}  // namespace

std::vector<std::uint16_t> register_depth(const std::vector<std::uint16_t>& depth,
                                          const DeviceGeometry& g) {
  std::vector<std::uint16_t> out(g.color.width * g.color.height, 0);
  std::size_t i = 0;
  for (int v = 0; v < g.depth.height; ++v) {
    for (int u = 0; u < g.depth.width; ++u, ++i) {
      if (depth[i] == 0) continue;
      const double z = depth[i] * g.depth_unit;
      const Eigen::Vector2d low = carried(g, u - 0.5, v - 0.5, z);
      const Eigen::Vector2d high = carried(g, u + 0.5, v + 0.5, z);
      // The pixels whose centres lie in [low, high): neighbours share none.
      const int first_x = std::max(0, static_cast<int>(std::ceil(low.x())));
      const int first_y = std::max(0, static_cast<int>(std::ceil(low.y())));
      const int end_x = std::min(g.color.width, static_cast<int>(std::ceil(high.x())));
      const int end_y = std::min(g.color.height, static_cast<int>(std::ceil(high.y())));
      for (int y = first_y; y < end_y; ++y) {
        for (int x = first_x; x < end_x; ++x) {
          std::uint16_t& place = out[y * g.color.width + x];
          if (place == 0 || depth[i] < place) place = depth[i];
        }
      }
    }
  }
  close_gaps(g.color, out);
  return out;
}

Alignment judge_registration(const std::vector<std::uint16_t>& before,
                             const std::vector<std::uint16_t>& after,
                             const DeviceGeometry& geometry) {
  constexpr int kFewest = 200;
  const std::vector<std::uint16_t> expected = register_depth(before, geometry);
  if (expected.size() != after.size() || before.size() != after.size()) {
    return Alignment::cannot_tell;
  }
  int telling = 0, for_it = 0, against_it = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (before[i] == 0 || expected[i] == 0 || after[i] == 0) continue;
    const int apart = std::abs(before[i] - expected[i]);
    if (100 * apart <= before[i]) continue;
    ++telling;
    if (2 * std::abs(after[i] - expected[i]) < apart) ++for_it;
    if (2 * std::abs(after[i] - before[i]) < apart) ++against_it;
  }
  // Where neither fits, something else was in view by then.
  if (telling < kFewest || 2 * (for_it + against_it) < telling) return Alignment::cannot_tell;
  return for_it > against_it ? Alignment::registered : Alignment::not_registered;
}

}  // namespace bpa::camera
