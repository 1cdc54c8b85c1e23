// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/random.hpp"
#include "core/cloud/frame.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/geometry/pose.hpp"

// Frames of scenes made of boxes, spheres and cylinders, by exact intersection of rays with the
// solids: nothing of the project's own rendering or geometry is used.

namespace bpa::test {

/// A convex body about the origin of its own frame.
struct Solid {
  enum class Kind { box, sphere, cylinder };
  Kind kind = Kind::box;
  Eigen::Vector3d half = Eigen::Vector3d::Ones();  ///< Box: half edges. Sphere: radius in x.
                                                   ///< Cylinder along z: radius, -, half height.
  Pose camera_from_solid;
};

struct SolidHit {
  double distance = std::numeric_limits<double>::infinity();  ///< In units of the direction.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();           ///< Out of the solid.
};

namespace detail {

inline std::optional<SolidHit> hit_box(const Eigen::Vector3d& half, const Eigen::Vector3d& o,
                                       const Eigen::Vector3d& d) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (std::abs(d[k]) < 1e-12) {
      if (std::abs(o[k]) > half[k]) return std::nullopt;
      continue;
    }
    const double sign = d[k] > 0 ? 1.0 : -1.0;
    const double first = (-sign * half[k] - o[k]) / d[k];
    leave = std::min(leave, (sign * half[k] - o[k]) / d[k]);
    if (first > enter) {
      enter = first;
      normal = -sign * Eigen::Vector3d::Unit(k);
    }
  }
  if (enter <= 0 || enter > leave) return std::nullopt;
  return SolidHit{enter, normal};
}

// The nearer root of a t^2 + 2 b t + c = 0.
inline std::optional<double> first_root(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (a < 1e-15 || discriminant < 0) return std::nullopt;
  return (-b - std::sqrt(discriminant)) / a;
}

inline std::optional<SolidHit> hit_sphere(double radius, const Eigen::Vector3d& o,
                                          const Eigen::Vector3d& d) {
  const auto t = first_root(d.squaredNorm(), o.dot(d), o.squaredNorm() - radius * radius);
  if (!t || *t <= 0) return std::nullopt;
  return SolidHit{*t, (o + *t * d) / radius};
}

inline std::optional<SolidHit> hit_cylinder(double radius, double half_height,
                                            const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  SolidHit best;
  const auto side = first_root(d.head<2>().squaredNorm(), o.head<2>().dot(d.head<2>()),
                               o.head<2>().squaredNorm() - radius * radius);
  if (side && *side > 0 && std::abs(o.z() + *side * d.z()) <= half_height) {
    const Eigen::Vector3d p = o + *side * d;
    best = {*side, Eigen::Vector3d(p.x(), p.y(), 0) / radius};
  }
  const double sign = d.z() > 0 ? -1.0 : 1.0;  // the cap that faces the ray
  const double cap = (sign * half_height - o.z()) / d.z();
  if (std::isfinite(cap) && cap > 0 && (o + cap * d).head<2>().norm() <= radius &&
      cap < best.distance) {
    best = {cap, sign * Eigen::Vector3d::UnitZ()};
  }
  if (!std::isfinite(best.distance)) return std::nullopt;
  return best;
}

}  // namespace detail

/// Where the ray from the camera's centre meets the solid first; all in the camera's frame.
inline std::optional<SolidHit> hit(const Solid& solid, const Eigen::Vector3d& direction) {
  const Pose solid_from_camera = solid.camera_from_solid.inverse();
  const Eigen::Vector3d o = solid_from_camera.translation;
  const Eigen::Vector3d d = solid_from_camera.rotation * direction;
  auto found = solid.kind == Solid::Kind::box ? detail::hit_box(solid.half, o, d)
               : solid.kind == Solid::Kind::sphere
                   ? detail::hit_sphere(solid.half.x(), o, d)
                   : detail::hit_cylinder(solid.half.x(), solid.half.z(), o, d);
  if (found) found->normal = solid.camera_from_solid.rotation * found->normal;
  return found;
}

/// A frame and the truth about each of its pixels.
struct SolidImage {
  Frame frame;
  std::vector<int> solid;                ///< Index of the solid seen; -1 for none.
  std::vector<Eigen::Vector3d> normals;  ///< True surface normals, camera frame.

  /// The solid and its normal at a pixel of a reduced map (the frame pixel at the block's corner).
  std::size_t index_of(const SurfaceMap& map, std::size_t i) const {
    const auto u = static_cast<int>(i) % map.width() * map.reduction;
    const auto v = static_cast<int>(i) / map.width() * map.reduction;
    return static_cast<std::size_t>(v * frame.camera.width + u);
  }
};

/// A Kinect-like camera of 640x480 or, the same field of view, a smaller one.
inline Camera kinect_camera(int width = 640) {
  const double scale = width / 640.0;
  return {width,       width * 3 / 4,     525 * scale,
          525 * scale, 0.5 * (width - 1), 0.5 * (width * 3 / 4 - 1)};
}

/// Renders the solids; `noise` in units of the sensor's own depth noise.
inline SolidImage render(const std::vector<Solid>& solids, const Camera& camera, float noise = 0,
                         std::uint64_t seed = 0) {
  SolidImage image;
  image.frame.camera = camera;
  image.frame.frame_id = "camera";
  const auto size = static_cast<std::size_t>(camera.width * camera.height);
  image.frame.depth.assign(size, 0);
  image.solid.assign(size, -1);
  image.normals.assign(size, Eigen::Vector3d::Zero());
  RandomStream random(seed, 99);
  for (std::size_t i = 0; i < size; ++i) {
    const auto u = static_cast<int>(i) % camera.width;
    const auto v = static_cast<int>(i) / camera.width;
    const Eigen::Vector3d direction = camera.unproject(u, v, 1);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < solids.size(); ++k) {
      const auto found = hit(solids[k], direction);
      if (!found || found->distance >= nearest) continue;
      nearest = found->distance;  // the direction has z = 1: distance is depth
      image.solid[i] = static_cast<int>(k);
      image.normals[i] = found->normal;
    }
    if (!std::isfinite(nearest)) continue;
    const auto z = static_cast<float>(nearest);
    image.frame.depth[i] =
        noise > 0 ? z + noise * depth_noise(z) * static_cast<float>(random.normal()) : z;
  }
  return image;
}

/// camera_from_world of a camera at `eye` that looks at `target`; the world's z is up.
inline Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d world_from_camera;
  world_from_camera << x, z.cross(x), z;
  return Pose::from_matrix(world_from_camera, eye).inverse();
}

/// A table of 1.4 m x 1.4 m with its top at the world's z = 0.
inline Solid table(const Pose& camera_from_world) {
  const Pose world_from_table{Eigen::Quaterniond::Identity(), {0, 0, -0.02}};
  return {Solid::Kind::box, {0.7, 0.7, 0.02}, camera_from_world * world_from_table};
}

/// Turned about the vertical by `angle` and moved; a pose in the world.
inline Pose standing_at(double x, double y, double z, double angle) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

/// A camera that looks down at the origin, and an object of 4 cm height that stands there.
inline const Pose kCameraFromWorld = look_at({0.1, -0.6, 0.5}, {0, 0, 0});
inline const Pose kTruth = kCameraFromWorld * standing_at(0, 0, 0.02, 0.7);

}  // namespace bpa::test
