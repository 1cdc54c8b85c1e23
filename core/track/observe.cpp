// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/observe.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "core/cloud/cielab.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa::track {
namespace {

constexpr int kSmallest = 16;  // pixels of the reduced image: a Camera's least size

SceneFeatures observed(const Frame& frame, SurfaceMapOptions options, SensorKind sensor,
                       std::span<const Plane> background) {
  options.sensor = std::string(name_of(sensor));
  SceneFeatures scene;
  scene.map = surface_map(frame, options);
  for (const Plane& plane : background) label_background(scene.map, plane);
  scene.planes.assign(background.begin(), background.end());
  scene.image = make_check_image(scene.map);
  return scene;
}

// And the part of the frame.
std::pair<Frame, SceneFeatures> observed_part(const Frame& frame, const RegionOfInterest& part,
                                              SensorKind sensor,
                                              std::span<const Plane> background) {
  SurfaceMapOptions options;
  options.max_width = part.width / map_reduction(frame.camera.width, options.max_width);
  options.num_threads = 1;
  Frame cropped = crop(frame, part);
  SceneFeatures scene = observed(cropped, options, sensor, background);
  return {std::move(cropped), std::move(scene)};
}

}  // namespace

SceneFeatures observe(const Frame& frame, SensorKind sensor, std::span<const Plane> background,
                      int num_threads) {
  SurfaceMapOptions options;
  options.num_threads = num_threads;
  return observed(frame, options, sensor, background);
}

SceneFeatures observe_part(const Frame& frame, const RegionOfInterest& part, SensorKind sensor,
                           std::span<const Plane> background) {
  return observed_part(frame, part, sensor, background).second;
}

SceneFeatures observe_part_colors(const Frame& frame, const RegionOfInterest& part,
                                  SensorKind sensor, std::span<const Plane> background) {
  auto [cropped, scene] = observed_part(frame, part, sensor, background);
  if (cropped.color.empty()) return scene;
  SceneFeatureOptions features;
  features.num_threads = 1;
  const Image<Eigen::Vector3f> rgb = reduced_color(cropped, scene.map, 1);
  add_colors(rgb, cielab(rgb, 1), features, scene);
  return scene;
}

std::optional<RegionOfInterest> surroundings(const Frame& frame, const ObjectModel& model,
                                             const Pose& camera_from_object, double margin_m) {
  const Camera& camera = frame.camera;
  const FastPose pose = to_fast(camera_from_object);
  Eigen::AlignedBox2d box;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& point : model.index->check.points) {
    const Eigen::Vector3d at = (pose * point).cast<double>();
    if (!(at.z() > kNearest_m)) return std::nullopt;
    box.extend(camera.project(at));
    nearest = std::min(nearest, at.z());
  }
  const int r = map_reduction(camera.width, SurfaceMapOptions().max_width);
  // The range of an axis with its margin, in whole pixels of the reduced image.
  const auto range = [&](double from, double to, double focal, int size) {
    const double margin = focal * margin_m / nearest, last = size / r;
    const int low = static_cast<int>(std::clamp(std::floor((from - margin) / r), 0.0, last));
    const int high = static_cast<int>(std::clamp(std::ceil((to + margin) / r), 0.0, last));
    return std::pair(low * r, (high - low) * r);
  };
  RegionOfInterest out;
  std::tie(out.x, out.width) = range(box.min().x(), box.max().x(), camera.fx, camera.width);
  std::tie(out.y, out.height) = range(box.min().y(), box.max().y(), camera.fy, camera.height);
  if (std::min(out.width, out.height) < kSmallest * r) return std::nullopt;
  return out;
}

std::vector<float> sampled_depths(const Frame& frame, RegionOfInterest region, int step) {
  if (region.empty()) region = {0, 0, frame.camera.width, frame.camera.height};
  std::vector<float> out;
  for (int v = region.y; v < region.y + region.height; v += step) {
    for (int u = region.x; u < region.x + region.width; u += step) {
      out.push_back(frame.depth[static_cast<std::size_t>(v) * frame.camera.width + u]);
    }
  }
  return out;
}

double changed_share(const std::vector<float>& now, const std::vector<float>& then,
                     const SensorNoise& noise) {
  if (now.size() != then.size()) return 1;
  int changed = 0, known = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!(now[i] > 0) || !(then[i] > 0)) continue;  // depth comes and goes at rims
    ++known;
    changed += std::abs(now[i] - then[i]) > tolerance::kOnSurface(noise(now[i]));
  }
  return known > 0 ? static_cast<double>(changed) / known : 1;
}

}  // namespace bpa::track
