// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/matches.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
namespace {

constexpr int kShadow = 8;  // pixels without depth beside an edge, at most

// A walk over the image, one pixel a step, from (u0, v0).
struct Walk {
  const CheckImage& image;
  float u0, v0, du, dv;

  // The pixel `step` steps outward; null outside of the image.
  const CheckPixel* at(int step) const {
    const float u = u0 + static_cast<float>(step) * du, v = v0 + static_cast<float>(step) * dv;
    if (!(u >= 0 && v >= 0)) return nullptr;
    const int x = static_cast<int>(u), y = static_cast<int>(v);
    if (x >= image.width || y >= image.height) return nullptr;
    return &image.pixels[y * image.width + x];
  }

  // True when what follows the last pixel of a surface of depth `depth` lies behind it.
  bool ends_after(int step, float depth, float jump) const {
    for (int k = 1; k <= kShadow; ++k) {
      const CheckPixel* next = at(step + k);
      if (!next) return false;  // the image's border
      if (next->depth > 0) return next->depth > depth + (k == 1 ? jump : 0.0f) || !next->searched;
    }
    return true;
  }
};

}  // namespace

bool match_surface(const SceneFeatures& scene, const CheckPoints& points, std::size_t i,
                   const FastPose& pose, float gate, SurfaceMatch& match) {
  match.model_normal = pose.rotation * points.normals[i];
  match.model_point = pose * points.points[i];
  const Eigen::Vector3f& p = match.model_point;
  if (match.model_normal.dot(p) > -kMatchFacing * p.z()) return false;
  const int pixel = scene.image.pixel_of(p);
  if (pixel < 0) return false;
  match.pixel = static_cast<std::size_t>(pixel);
  const CheckPixel& seen = scene.image.pixels[match.pixel];  // rejects most of the others
  if (!seen.searched || std::abs(seen.depth - p.z()) >= gate) return false;
  match.scene_point = scene.map.points[match.pixel];
  match.scene_normal = scene.map.normals[match.pixel];
  return (match.scene_point - p).squaredNorm() < gate * gate &&
         match.scene_normal.dot(match.model_normal) > kMatchCosine;
}

EdgePoint edge_point(const ViewEdge& edge, const FastPose& pose) {
  return {pose * edge.point, pose.rotation * edge.outward};
}

std::optional<float> match_edge(const CheckImage& image, const EdgePoint& edge, float reach) {
  const Eigen::Vector3f& p = edge.point;
  if (!(p.z() > kNearest_m)) return std::nullopt;
  // The image direction of `outward`, and how far along it a pixel goes.
  const float inverse_z = 1 / p.z();
  const float x = p.x() * inverse_z, y = p.y() * inverse_z;
  const float du = image.fx * inverse_z * (edge.outward.x() - x * edge.outward.z());
  const float dv = image.fy * inverse_z * (edge.outward.y() - y * edge.outward.z());
  const float pixels_per_metre = std::sqrt(du * du + dv * dv);
  if (!(pixels_per_metre > 1)) return std::nullopt;
  const float step = 1 / pixels_per_metre;
  const Eigen::Vector2f at = image.project(p);
  const Walk walk{image, at.x() + 0.5f, at.y() + 0.5f, du * step, dv * step};
  const int steps = std::max(1, static_cast<int>(reach * pixels_per_metre));
  const float noise = image.noise(p.z());
  const float jump = tolerance::kGoesOn(noise), near = tolerance::kFollowed(noise);
  int k = -steps;
  const CheckPixel* here = walk.at(k);
  const auto on_model = [&](const CheckPixel* pixel) {
    return pixel && pixel->searched && std::abs(pixel->depth - p.z()) < near;
  };
  while (k < steps && !on_model(here)) here = walk.at(++k);
  for (; k < steps; ++k) {
    const CheckPixel* next = walk.at(k + 1);
    if (!next) return std::nullopt;
    const bool goes_on =
        next->depth > 0 && next->searched && std::abs(next->depth - here->depth) < jump;
    if (!goes_on) break;
    here = next;
  }
  if (k < steps && walk.ends_after(k, here->depth, jump))
    return (static_cast<float>(k) + 0.5f) * step;
  return std::nullopt;
}

}  // namespace bpa::detect
