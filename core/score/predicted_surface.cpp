// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/predicted_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bpa {
namespace {

constexpr float kMinCosine = 0.05f;      // between normal and line of sight
constexpr float kPointRadius = 0.0019f;  // metres; 0.75 of the usual spacing of surface points
constexpr float kMaxRadius = 4;          // pixels
constexpr float kPlaneReach = 0.01f;     // metres in depth

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
  float z;  // metres
  Span us, vs;
  std::uint32_t index;
  Eigen::Vector3f normal;
  float offset;  // of the tangent plane: normal . x = offset

  // Of the tangent plane at a pixel, as long as it is near the point.
  float depth_at(const CheckImage& image, int pixel_u, int pixel_v) const {
    const Eigen::Vector3f ray((static_cast<float>(pixel_u) - image.cx) / image.fx,
                              (static_cast<float>(pixel_v) - image.cy) / image.fy, 1);
    const float depth = offset / normal.dot(ray);
    return std::abs(depth - z) < kPlaneReach ? depth : z;
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
    const float radius = std::min(kMaxRadius, kPointRadius * image.fx / p.z());
    if (!(u > -1 && v > -1 && u < static_cast<float>(image.width) &&
          v < static_cast<float>(image.height))) {
      continue;
    }
    drawn.push_back({p.z(), covered(u, radius, image.width), covered(v, radius, image.height), i,
                     normal, offset});
  }
  return drawn;
}

PredictedSurface draw(const CheckImage& image, const std::vector<DrawnPoint>& drawn) {
  if (drawn.empty()) return {};
  Span columns{image.width, -1}, rows{image.height, -1};
  for (const DrawnPoint& p : drawn) {
    columns = {std::min(columns.first, p.us.first), std::max(columns.last, p.us.last)};
    rows = {std::min(rows.first, p.vs.first), std::max(rows.last, p.vs.last)};
  }
  if (columns.last < columns.first || rows.last < rows.first) return {};
  const int width = columns.last - columns.first + 1, height = rows.last - rows.first + 1;
  PredictedSurface out{columns.first, rows.first, {width, height, 0.0f}, {width, height, 0u}};
  for (const DrawnPoint& p : drawn) {
    for (int v = p.vs.first; v <= p.vs.last; ++v) {
      for (int u = p.us.first; u <= p.us.last; ++u) {
        const std::size_t i = out.depth.index(u - out.u0, v - out.v0);
        const float depth = p.depth_at(image, u, v);
        if (out.depth[i] > 0 && out.depth[i] <= depth) continue;
        out.depth[i] = depth;
        out.point[i] = p.index;
      }
    }
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

}  // namespace bpa
