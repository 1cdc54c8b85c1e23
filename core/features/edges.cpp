// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/edges.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/base/parallel.hpp"
#include "core/cloud/blur.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa::features {
namespace {

bool inside(const SurfaceMap& map, int u, int v) {
  return u >= 0 && v >= 0 && u < map.width() && v < map.height();
}

// The next pixel with a depth from (u, v) along a step; -1 when there is none within the gap.
int next_valid(const SurfaceMap& map, int u, int v, const int (&step)[2], int max_gap) {
  for (int k = 1; k <= max_gap + 1; ++k) {
    const int x = u + k * step[0], y = v + k * step[1];
    if (!inside(map, x, y)) return -1;
    const int index = y * map.width() + x;
    if (map.depth[index] > 0) return index;
  }
  return -1;
}

RangeEdge classify(const SurfaceMap& map, int u, int v, int max_gap) {
  constexpr int kSteps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const int here = v * map.width() + u;
  if (map.depth[here] <= 0) return RangeEdge::none;
  RangeEdge edge = RangeEdge::none;
  for (const auto& step : kSteps) {
    const int there = next_valid(map, u, v, step, max_gap);
    if (there < 0 || !surface_breaks(map, here, there)) continue;
    if (map.depth[here] < map.depth[there]) return RangeEdge::occluding;
    edge = RangeEdge::occluded;
  }
  return edge;
}

// Pixels to either side that span the baseline on a surface seen from the front.
int baseline_px(const SurfaceMap& map, float z, const CurvatureEdgeOptions& options) {
  const double pixels = options.baseline_m * map.camera.fx / static_cast<double>(z);
  return static_cast<int>(std::lround(std::clamp(pixels, 1.0, options.max_baseline_px)));
}

// The index of a pixel whose normal is on the same surface as `centre`; -1 where there is none.
int usable(const SurfaceMap& map, int centre, int u, int v) {
  if (!inside(map, u, v)) return -1;
  const int index = v * map.width() + u;
  const bool known = map.depth[index] > 0 && map.normals[index].squaredNorm() > 0;
  return known && !surface_breaks(map, centre, index) ? index : -1;
}

void fill_pixel(const SurfaceMap& map, int u, int v, const CurvatureEdgeOptions& options,
                HollowMap& out) {
  const int centre = v * map.width() + u;
  if (map.depth[centre] <= 0 || map.normals[centre].squaredNorm() == 0) return;
  const int reach = baseline_px(map, map.depth[centre], options);
  bool known = false;
  for (std::uint8_t d = 0; d < 4; ++d) {
    const bool diagonal = d % 2 == 1;
    const int steps = diagonal ? std::max(1, (reach * 5 + 3) / 7) : reach;  // over sqrt(2)
    const int du = steps * kHollowDirections[d][0], dv = steps * kHollowDirections[d][1];
    const int one = usable(map, centre, u + du, v + dv);
    const int other = usable(map, centre, u - du, v - dv);
    if (one < 0 || other < 0) continue;
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

Image<RangeEdge> range_edges(const SurfaceMap& map, const RangeEdgeOptions& options) {
  Image<RangeEdge> edges(map.width(), map.height(), RangeEdge::none);
  parallel_for(edges.height, options.num_threads, [&](int v) {
    for (int u = 0; u < edges.width; ++u) edges.at(u, v) = classify(map, u, v, options.max_gap_px);
  });
  return edges;
}

Image<std::uint8_t> image_edges(const Image<Eigen::Vector3f>& rgb,
                                const ImageEdgeOptions& options) {
  Image<std::uint8_t> edges(rgb.width, rgb.height, 0);
  if (rgb.empty()) return edges;
  Image<float> luminance(rgb.width, rgb.height, 0);
  const Eigen::Vector3f weights(0.299f, 0.587f, 0.114f);  // ITU-R BT.601
  for (std::size_t i = 0; i < rgb.size(); ++i) luminance[i] = weights.dot(rgb[i]);
  luminance = blur(luminance, options.blur_px, options.num_threads);
  Image<std::uint8_t> rounded(rgb.width, rgb.height, 0);
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    rounded[i] = static_cast<std::uint8_t>(std::clamp(luminance[i] + 0.5f, 0.0f, 255.0f));
  }
  const cv::Mat in(rgb.height, rgb.width, CV_8U, rounded.pixels.data());
  cv::Mat out(rgb.height, rgb.width, CV_8U, edges.pixels.data());
  // A step of height h has a Sobel gradient of 4 h.
  cv::Canny(in, out, 4 * std::min(options.low, options.high), 4 * options.high, 3, true);
  for (std::uint8_t& value : edges.pixels) value = value != 0;
  return edges;
}

HollowMap hollow_map(const SurfaceMap& map, const CurvatureEdgeOptions& options) {
  HollowMap out{{map.width(), map.height(), 0.0f}, {map.width(), map.height(), std::uint8_t{0}}};
  parallel_for(map.height(), options.num_threads, [&](int v) {
    for (int u = 0; u < map.width(); ++u) fill_pixel(map, u, v, options, out);
  });
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

}  // namespace bpa::features
