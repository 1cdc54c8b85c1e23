// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "core/cloud/surface_map.hpp"

namespace bpa {

/// The step in depth, at depth z and of a surface seen from the front, that is no noise, metres.
/// A floor and standard deviations of depth, chosen by hand.
inline float break_step(float z) {
  constexpr float kFloor = 0.006f, kSigmas = 3;  // metres; times depth_noise()
  return kFloor + kSigmas * depth_noise(z);
}

namespace detail {

/// Whether the tangent plane at one pixel, met by the ray of another, is where that one's surface
/// is. A surface seen at less than 9 degrees predicts nothing.
inline bool plane_reaches(const SurfaceMap& map, std::size_t from, std::size_t to, float step) {
  const Eigen::Vector3f& normal = map.normals[from];
  const Eigen::Vector3f& target = map.points[to];
  const float along = normal.dot(target);
  constexpr float kGrazing = 0.15f;  // cosine of 81 degrees
  if (!(along < -kGrazing * target.norm())) return false;
  const float scale = normal.dot(map.points[from]) / along;  // of the target, to lie on the plane
  return std::abs(scale - 1) * target.z() < step;
}

}  // namespace detail

/// Whether the surface breaks off between two pixels a few apart, both of which have a depth: their
/// depths differ by more than break_step, and neither lies on the other's tangent plane.
inline bool surface_breaks(const SurfaceMap& map, std::size_t a, std::size_t b) {
  const float za = map.depth[a], zb = map.depth[b];
  const float step = break_step(std::min(za, zb));
  if (std::abs(za - zb) < step) return false;
  return !detail::plane_reaches(map, a, b, step) && !detail::plane_reaches(map, b, a, step);
}

}  // namespace bpa
