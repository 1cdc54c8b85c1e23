// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/background.hpp"

#include <cmath>
#include <string>

#include "core/cloud/surface_map.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::track {
namespace {

constexpr int kMapWidth = 160;         // pixels: enough for planes of 0.35 m
constexpr int kPlaneStep_px = 8;       // between the depths that are compared with a plane
constexpr double kLeastShare = 0.15;   // of the depths: smaller ones may pass through objects
constexpr double kLeastOfShare = 0.6;  // of the share of depths on a plane, of what it was

double share_on(const Plane& plane, const Frame& frame, const SensorNoise& noise) {
  int known = 0, on = 0;
  for (int v = 0; v < frame.camera.height; v += kPlaneStep_px) {
    for (int u = 0; u < frame.camera.width; u += kPlaneStep_px) {
      const float z = frame.depth[static_cast<std::size_t>(v) * frame.camera.width + u];
      if (!(z > 0)) continue;
      ++known;
      const Eigen::Vector3f point = frame.camera.unproject(u, v, z).cast<float>();
      on += std::abs(plane.height(point)) < tolerance::kGoesOn(noise(z));
    }
  }
  return known > 0 ? static_cast<double>(on) / known : 0;
}

}  // namespace

void Background::find(const Frame& frame, SensorKind sensor, const Pose& frame_from_camera) {
  SurfaceMapOptions options;
  options.max_width = kMapWidth;
  options.sensor = std::string(name_of(sensor));
  noise_ = noise_of(sensor);
  options.num_threads = 1;
  SurfaceMap map = surface_map(frame, options);
  planes_.clear();
  shares_.clear();
  for (const Plane& plane : label_background_planes(map, {})) {
    const double share = share_on(plane, frame, noise_);
    if (share < kLeastShare) continue;
    planes_.push_back(transformed(frame_from_camera, plane));
    shares_.push_back(share);
  }
}

void Background::check(const Frame& frame, const Pose& frame_from_camera) {
  for (std::size_t i = planes_.size(); i-- > 0;) {
    const Plane plane = transformed(frame_from_camera.inverse(), planes_[i]);
    if (share_on(plane, frame, noise_) >= kLeastOfShare * shares_[i]) continue;
    planes_.erase(planes_.begin() + static_cast<std::ptrdiff_t>(i));
    shares_.erase(shares_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace bpa::track
