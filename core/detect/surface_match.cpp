// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/surface_match.hpp"

namespace bpa {

bool match_surface(const SceneFeatures& scene, const CheckPoints& points, std::size_t i,
                   const FastPose& pose, float gate, SurfaceMatch& match) {
  constexpr float kMinFacing = 0.1f;  // cosine between normal and optical axis, seen from far
  constexpr float kMinCosine = 0.6f;  // between the normals of model and surface
  match.model_normal = pose.rotation * points.normals[i];
  match.model_point = pose * points.points[i];
  const Eigen::Vector3f& p = match.model_point;
  if (match.model_normal.dot(p) > -kMinFacing * p.z()) return false;
  const int pixel = scene.image.pixel_of(p);
  if (pixel < 0) return false;
  match.pixel = static_cast<std::size_t>(pixel);
  if (!scene.map.searched[match.pixel]) return false;
  match.scene_point = scene.map.points[match.pixel];
  match.scene_normal = scene.map.normals[match.pixel];
  return (match.scene_point - p).squaredNorm() < gate * gate &&
         match.scene_normal.dot(match.model_normal) > kMinCosine;
}

}  // namespace bpa
