// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/surface_match.hpp"

#include <cmath>

namespace bpa {

bool match_surface(const SceneFeatures& scene, const CheckPoints& points, std::size_t i,
                   const FastPose& pose, float gate, SurfaceMatch& match) {
  constexpr float kMinFacing = 0.1f;  // cosine between normal and optical axis, seen from far
  constexpr float kMinCosine = 0.6f;  // between the normals of model and surface
  match.model_normal = pose.rotation * points.normals[i];
  match.model_point = pose * points.points[i];
  const Eigen::Vector3f& p = match.model_point;
  if (p.z() < 0.1f || match.model_normal.dot(p) > -kMinFacing * p.z()) return false;
  const CheckImage& image = scene.image;
  const auto u = static_cast<int>(std::floor(image.fx * p.x() / p.z() + image.cx + 0.5f));
  const auto v = static_cast<int>(std::floor(image.fy * p.y() / p.z() + image.cy + 0.5f));
  if (u < 0 || v < 0 || u >= image.width || v >= image.height) return false;
  const auto index = static_cast<std::size_t>(v * image.width + u);
  if (!scene.map.searched[index]) return false;
  match.pixel = index;
  match.scene_point = scene.map.points[index];
  match.scene_normal = scene.map.normals[index];
  return (match.scene_point - p).squaredNorm() < gate * gate &&
         match.scene_normal.dot(match.model_normal) > kMinCosine;
}

}  // namespace bpa
