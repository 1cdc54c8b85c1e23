// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/segment/pixel_features.hpp"

#include <cmath>

#include "core/base/parallel.hpp"

namespace bpa::detail {

PixelFeatures pixel_features(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                             const SuperPixelOptions& options) {
  const auto normal_scale =
      static_cast<float>(1 / (2 * std::sin(0.5 * options.angle_deg * M_PI / 180)));
  const auto color_scale = static_cast<float>(1 / options.color);
  PixelFeatures features(map.size());
  parallel_for(
      map.height(), options.num_threads,
      [&](int v) {
        for (int u = 0; u < map.width(); ++u) {
          const auto i = static_cast<std::size_t>(v * map.width() + u);
          if (map.depth[i] <= 0 || map.normals[i].squaredNorm() == 0) continue;
          features[i].position << map.points[i], 1;
          features[i].normal << normal_scale * map.normals[i], 0;
          if (!lab.empty()) features[i].color << color_scale * lab[i], 0;
        }
      },
      16);
  return features;
}

float inverse_spacing_squared(const SurfaceMap& map, const SuperPixelOptions& options, float z) {
  const float spacing = static_cast<float>(options.spacing_px / map.camera.fx) * z;
  return 1 / (spacing * spacing);
}

}  // namespace bpa::detail
