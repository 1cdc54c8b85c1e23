// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/edge_image.hpp"

#include <algorithm>

#include "core/cloud/blur.hpp"

namespace bpa {

Image<float> edge_image(const Image<RangeEdge>& range, const Image<std::uint8_t>& image,
                        const Image<std::uint8_t>& curvature, const EdgeImageOptions& options) {
  const auto range_weight = static_cast<float>(options.range_weight);
  const auto image_weight = static_cast<float>(options.image_weight);
  const auto curvature_weight = static_cast<float>(options.curvature_weight);
  Image<float> sum(range.width, range.height, 0);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] = range_weight * static_cast<float>(range[i] != RangeEdge::none) +
             image_weight * static_cast<float>(image[i]) +
             curvature_weight * static_cast<float>(curvature[i]);
  }
  Image<float> out = blur(sum, options.blur_px, options.num_threads);
  const float largest = std::max({range_weight, image_weight, curvature_weight});
  const float unit = largest > 0 ? 1 / (largest * blurred_line_peak(options.blur_px)) : 0;
  for (float& value : out.pixels) value = std::min(1.0f, value * unit);
  return out;
}

SceneEdges scene_edges(const SurfaceMap& map, const Image<Eigen::Vector3f>& rgb,
                       const EdgeImageOptions& options) {
  EdgeImageOptions each = options;
  each.range.num_threads = each.image.num_threads = each.curvature.num_threads =
      options.num_threads;
  SceneEdges edges;
  edges.range = range_edges(map, each.range);
  edges.image = rgb.empty() ? Image<std::uint8_t>(map.width(), map.height(), 0)
                            : image_edges(rgb, each.image);
  edges.curvature = curvature_edges(map, each.curvature);
  edges.likelihood = edge_image(edges.range, edges.image, edges.curvature, each);
  return edges;
}

}  // namespace bpa
