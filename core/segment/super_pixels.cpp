// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/segment/super_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/cloud/surface_map.hpp"
#include "core/segment/pixel_features.hpp"

namespace bpa::segment {
namespace {

// Standard deviations of what two segments of one object differ by; chosen by hand.
constexpr float kEdgeScale = 0.4f;  // edge likelihood
constexpr float kHollowAngle = 40 * static_cast<float>(M_PI) / 180;
constexpr float kBulgeAngle = 2 * kHollowAngle;

std::vector<Segment> describe(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                              const Image<std::int32_t>& labels) {
  std::vector<Segment> segments(labels.empty() ? 0 : 1 + std::ranges::max(labels.pixels));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] < 0) continue;
    Segment& segment = segments[labels[i]];
    segment.pixels.push_back(static_cast<std::uint32_t>(i));
    segment.mean_position += map.points[i];
    segment.mean_normal += map.normals[i];
    if (!lab.empty()) segment.mean_color += lab[i];
    const int u = static_cast<int>(i) % labels.width, v = static_cast<int>(i) / labels.width;
    const auto outside = [&](int x, int y) {
      return !labels.contains(x, y) || labels.at(x, y) != labels[i];
    };
    if (outside(u - 1, v) || outside(u + 1, v) || outside(u, v - 1) || outside(u, v + 1)) {
      segment.border.push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (Segment& segment : segments) {
    const float share = 1 / static_cast<float>(segment.pixels.size());
    segment.mean_position *= share;
    segment.mean_color *= share;
    segment.mean_normal.normalize();
  }
  return segments;
}

std::vector<SegmentPair> touching_pairs(const SurfaceMap& map, const Image<std::int32_t>& labels,
                                        const Image<float>& edges) {
  std::map<std::pair<int, int>, SegmentPair> found;
  const auto add = [&](int i, int j) {
    const auto [first, second] = std::minmax(labels[i], labels[j]);
    if (first < 0 || first == second) return;
    SegmentPair& pair =
        found.try_emplace({first, second}, SegmentPair{first, second}).first->second;
    ++pair.contact;
    pair.breaks += surface_breaks(map, i, j);
    pair.edge += std::max(edges[i], edges[j]);
  };
  for (int v = 0; v < labels.height; ++v) {
    for (int u = 0; u < labels.width; ++u) {
      const int i = v * labels.width + u;
      if (u + 1 < labels.width) add(i, i + 1);
      if (v + 1 < labels.height) add(i, i + labels.width);
    }
  }
  std::vector<SegmentPair> pairs;
  for (auto& [segments, pair] : found) {
    pair.edge /= static_cast<float>(pair.contact);
    pairs.push_back(pair);
  }
  return pairs;
}

float squared(float x) { return x * x; }

float angle_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::acos(std::clamp(a.dot(b), -1.0f, 1.0f));
}

}  // namespace

float segment_affinity(const Segment& first, const Segment& second, const SegmentPair& pair) {
  if (pair.contact <= 0) return 0;
  const Eigen::Vector3f apart = second.mean_position - first.mean_position;
  const bool hollow = (second.mean_normal - first.mean_normal).dot(apart) < 0;
  const float turn = angle_between(first.mean_normal, second.mean_normal);
  // On one smooth surface the chord makes opposite angles with the two tangent planes; a step makes
  // equal ones.
  const float length = std::max(apart.norm(), 1e-6f);
  const float step = std::asin(
      std::clamp(0.5f * (first.mean_normal + second.mean_normal).dot(apart) / length, -1.0f, 1.0f));
  const float misfit = turn + std::abs(step);
  const float energy =
      squared(pair.edge / kEdgeScale) + squared(misfit / (hollow ? kHollowAngle : kBulgeAngle));
  const float unbroken = 1 - static_cast<float>(pair.breaks) / static_cast<float>(pair.contact);
  return unbroken * std::exp(-0.5f * energy);
}

Segmentation super_pixels(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                          const Image<float>& edges, const SuperPixelOptions& options) {
  const detail::PixelFeatures features = detail::pixel_features(map, lab, options);
  Segmentation out;
  out.labels = detail::connect(map, features, edges, detail::cluster(map, features, edges, options),
                               options);
  out.segments = describe(map, lab, out.labels);
  out.pairs = touching_pairs(map, out.labels, edges);
  for (SegmentPair& pair : out.pairs) {
    pair.affinity = segment_affinity(out.segments[pair.first], out.segments[pair.second], pair);
  }
  return out;
}

}  // namespace bpa::segment
