// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/predicted_surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/geometry/tolerance.hpp"

namespace bpa::score {
namespace {

constexpr float kMinCosine = 0.05f;      // between normal and line of sight
constexpr float kPointRadius = 0.0019f;  // metres; 0.75 of the usual spacing of surface points
constexpr float kMaxRadius = 4;          // pixels
constexpr float kPlaneReach = tolerance::placed(4);  // metres in depth

struct Span {
  int first, last;  // both included
};

// The pixels whose centres are within the radius, the nearest one at least. `centre` is above -2.
Span covered(float centre, float radius, int size) {
  constexpr int kAbove = 16;  // makes every number positive, so that conversion rounds down
  const auto floor_of = [](float x) { return static_cast<int>(x + kAbove) - kAbove; };
  const int nearest = floor_of(centre + 0.5f);
  const int first = std::min(nearest, -floor_of(radius - centre + static_cast<float>(size)) + size);
  const int last = std::max(nearest, floor_of(centre + radius));
  return {std::max(0, first), std::min(size - 1, last)};
}

struct DrawnPoint {
  float u, v;       // pixels
  float inverse_z;  // 1 / metres
  Span us, vs;
  std::uint32_t index;
  // Of the tangent plane, whose inverse depth is linear in the image.
  float per_u, per_v;
  float least, most;  // inverse depths that are near the point's

  float inverse_depth_at(int pixel_u, int pixel_v) const {
    const float inverse = inverse_z + per_u * (static_cast<float>(pixel_u) - u) +
                          per_v * (static_cast<float>(pixel_v) - v);
    return inverse > least && inverse < most ? inverse : inverse_z;
  }
};

// Those of the points with these indices that face the camera.
std::vector<DrawnPoint> facing_points(const CheckImage& image, const ObjectModel& model,
                                      const auto& indices, const FastPose& pose) {
  std::vector<DrawnPoint> drawn;
  drawn.reserve(indices.size());
  for (const std::uint32_t i : indices) {
    const Eigen::Vector3f p = pose * model.surface.points[i];
    if (!(p.z() > kNearest_m)) continue;
    const Eigen::Vector3f normal = pose.rotation * model.surface.normals[i];
    const float offset = normal.dot(p);
    if (offset > 0 || offset * offset < kMinCosine * kMinCosine * p.squaredNorm()) continue;
    const Eigen::Vector2f at = image.project(p);
    const float u = at.x(), v = at.y();
    const float inverse_z = 1 / p.z();
    const float radius = std::min(kMaxRadius, kPointRadius * image.fx * inverse_z);
    if (!(u > -1 && v > -1 && u < static_cast<float>(image.width) &&
          v < static_cast<float>(image.height))) {
      continue;
    }
    const Span us = covered(u, radius, image.width), vs = covered(v, radius, image.height);
    if (us.last < us.first || vs.last < vs.first) continue;
    drawn.push_back({u, v, inverse_z, us, vs, i, normal.x() / (offset * image.fx),
                     normal.y() / (offset * image.fy), 1 / (p.z() + kPlaneReach),
                     1 / (p.z() - kPlaneReach)});
  }
  return drawn;
}

// A pixel of the depth buffer. The largest is the nearest; of equally near ones, the lowest index.
std::uint64_t buffer_key(float inverse_depth, std::uint32_t index) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(inverse_depth)} << 32 | ~index;
}

PredictedSurface draw(const CheckImage& image, const std::vector<DrawnPoint>& drawn) {
  if (drawn.empty()) return {};
  Span columns{image.width, -1}, rows{image.height, -1};
  for (const DrawnPoint& p : drawn) {
    columns = {std::min(columns.first, p.us.first), std::max(columns.last, p.us.last)};
    rows = {std::min(rows.first, p.vs.first), std::max(rows.last, p.vs.last)};
  }
  const int width = columns.last - columns.first + 1, height = rows.last - rows.first + 1;
  Image<std::uint64_t> nearest(width, height, 0);
  for (const DrawnPoint& p : drawn) {
    const auto draw_at = [&](int u, int v) {
      std::uint64_t& pixel = nearest.at(u - columns.first, v - rows.first);
      pixel = std::max(pixel, buffer_key(p.inverse_depth_at(u, v), p.index));
    };
    if (p.us.last - p.us.first <= 1 && p.vs.last - p.vs.first <= 1) {  // most points
      // Twice the same where it is one pixel wide: that costs less than a branch.
      draw_at(p.us.first, p.vs.first);
      draw_at(p.us.last, p.vs.first);
      draw_at(p.us.first, p.vs.last);
      draw_at(p.us.last, p.vs.last);
      continue;
    }
    for (int v = p.vs.first; v <= p.vs.last; ++v) {
      for (int u = p.us.first; u <= p.us.last; ++u) draw_at(u, v);
    }
  }
  PredictedSurface out{columns.first, rows.first, {width, height, 0.0f}, {width, height, 0u}};
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i] == 0) continue;
    out.depth[i] = 1 / std::bit_cast<float>(static_cast<std::uint32_t>(nearest[i] >> 32));
    out.point[i] = ~static_cast<std::uint32_t>(nearest[i]);
  }
  return out;
}

}  // namespace

PredictedSurface predict_surface(const CheckImage& image, const ObjectModel& model,
                                 const Pose& camera_from_object) {
  const FastPose pose = to_fast(camera_from_object);
  return draw(image,
              facing_points(image, model, nearest_view(model.index->views, pose).visible, pose));
}

PredictedSurface predict_whole_surface(const CheckImage& image, const ObjectModel& model,
                                       const Pose& camera_from_object) {
  std::vector<std::uint32_t> all(model.surface.points.size());
  std::iota(all.begin(), all.end(), 0U);
  return draw(image, facing_points(image, model, all, to_fast(camera_from_object)));
}

}  // namespace bpa::score
