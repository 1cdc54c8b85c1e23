// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/cloud/frame.hpp"
#include "core/cloud/sensor_noise.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa {

/// The surface seen in a frame, pixel by pixel. Coarser than the frame by `reduction` in each
/// direction: the depths of a block that belong to one surface are averaged, which removes noise
/// and keeps edges. Camera frame, metres.
struct SurfaceMap {
  Camera camera;                         ///< Of the reduced image.
  int reduction = 1;                     ///< Frame pixels per map pixel in each direction.
  std::vector<float> depth;              ///< 0 where there is none.
  std::vector<Eigen::Vector3f> points;   ///< Valid where depth > 0.
  std::vector<Eigen::Vector3f> normals;  ///< Toward the camera; zero where unknown.
  /// 0 beyond the range limit, on labelled background, and in excluded blocks: over half of the
  /// pixels on this surface are outside the region of interest or mask, or known background.
  std::vector<std::uint8_t> searched;
  SensorKind sensor = SensorKind::structured_light;  ///< That took the frame.
  SensorNoise noise;                                 ///< Of depth; that of `sensor`.

  int width() const { return camera.width; }
  int height() const { return camera.height; }
  std::size_t size() const { return depth.size(); }
};

struct SurfaceMapOptions {
  BPA_OPTION(double, max_range_m, 2.5, (0.2, 20),
             "Surface further away than this is ignored, metres.");
  double normal_radius_m = 0.010;  ///< Radius of the window a surface normal is fitted in, metres.
  BPA_OPTION(int, max_width, 400, (64, 8192),
             "Wider frames are halved until they are not wider, pixels.");
  BPA_OPTION(std::string, sensor, "auto", (kSensorChoices),
             "Kind of depth camera; auto tells it from each frame.");
  int num_threads = 0;  ///< 0: one per core. Does not change the result.
};

/// Frame pixels per map pixel in each direction: the fewest, up to 8, for which a map of a frame of
/// this width is not wider than `max_width`.
int map_reduction(int frame_width, int max_width);

/// Standard deviation of a Kinect-class depth at distance z, metres (Nguyen, Izadi and Lovell,
/// "Modeling Kinect Sensor Noise", 3DIMPVT 2012).
inline float depth_noise(float z) { return SensorNoise{}(z); }

/// The frame must be valid (validate(Frame)).
SurfaceMap surface_map(const Frame& frame, const SurfaceMapOptions& options);

/// The step in depth, at depth z and of a surface seen from the front, that is no noise, metres.
inline float break_step(const SensorNoise& noise, float z) { return tolerance::kBreaks(noise(z)); }

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
  const float step = break_step(map.noise, std::min(za, zb));
  if (std::abs(za - zb) < step) return false;
  return !detail::plane_reaches(map, a, b, step) && !detail::plane_reaches(map, b, a, step);
}

}  // namespace bpa
