// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/surface_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/parallel.hpp"

namespace bpa {
namespace {

// Chosen by hand, as all numbers of this file.
constexpr float kGateFloor = 0.008f;           // metres
constexpr float kGateSigmas = 4;               // standard deviations of depth
constexpr float kGatePerPixel = 0.004f;        // what a slope adds to the gate, metres per pixel
constexpr int kMinWindow = 2, kMaxWindow = 8;  // radius of the normal's window, pixels
constexpr int kDenseWindow = 4;                // larger windows take every second pixel
constexpr int kMinNormalPoints = 6;
constexpr int kMaxReduction = 8;

// Depths of one surface differ by less than this within a few pixels, unless it is seen at a
// grazing angle. Metres.
float same_surface_gate(const SensorNoise& noise, float z) {
  return kGateFloor + kGateSigmas * noise(z);
}

Camera reduced_camera(const Camera& camera, int reduction) {
  const double scale = 1.0 / reduction;
  const double shift = 0.5 * (reduction - 1);
  return {camera.width / reduction, camera.height / reduction,   camera.fx * scale,
          camera.fy * scale,        (camera.cx - shift) * scale, (camera.cy - shift) * scale};
}

// Calls visit(u, v, depth) for the pixels of the frame that pixel (column, row) of the map stands
// for.
void for_each_of_block(const Frame& frame, int column, int row, int reduction, const auto& visit) {
  for (int v = row * reduction; v < (row + 1) * reduction; ++v) {
    for (int u = column * reduction; u < (column + 1) * reduction; ++u) {
      visit(u, v, frame.depth[v * frame.camera.width + u]);
    }
  }
}

// The mean of the block's depths near its median, 0 when less than half of the block has a depth.
float block_depth(const Frame& frame, const SensorNoise& noise, int column, int row,
                  int reduction) {
  float values[kMaxReduction * kMaxReduction];
  int count = 0;
  for_each_of_block(frame, column, row, reduction, [&](int, int, float z) {
    if (z > 0 && std::isfinite(z)) values[count++] = z;
  });
  if (2 * count < reduction * reduction) return 0;
  std::sort(values, values + count);
  const float median = values[(count - 1) / 2];
  float sum = 0;
  int used = 0;
  for (int i = 0; i < count; ++i) {
    if (std::abs(values[i] - median) > same_surface_gate(noise, median)) continue;
    sum += values[i];
    ++used;
  }
  return sum / static_cast<float>(used);
}

bool pixel_searched(const Frame& frame, int u, int v) {
  const RegionOfInterest& roi = frame.roi;
  if (!roi.empty() &&
      (u < roi.x || v < roi.y || u >= roi.x + roi.width || v >= roi.y + roi.height)) {
    return false;
  }
  const int index = v * frame.camera.width + u;
  if (!frame.mask.empty() && frame.mask[index] == 0) return false;
  return frame.background.empty() || frame.background[index] == 0;
}

// Whether at least half of the block's pixels on the surface at `depth`, which stands for the
// block, are searched. Any of them would let a mask grow by up to a block to each side, and all of
// them shrink it; half keeps its area, and pixels on another surface have no say.
bool block_searched(const Frame& frame, const SensorNoise& noise, int column, int row,
                    int reduction, float depth) {
  int searched = 0, on_surface = 0;
  for_each_of_block(frame, column, row, reduction, [&](int u, int v, float z) {
    if (!(std::abs(z - depth) <= same_surface_gate(noise, depth))) return;
    ++on_surface;
    searched += pixel_searched(frame, u, v);
  });
  return searched > 0 && 2 * searched >= on_surface;
}

// The normal of the plane fitted to the neighbours that lie on the same surface; zero when fewer
// than kMinNormalPoints do.
Eigen::Vector3f fit_normal(const SurfaceMap& map, int u, int v, int radius) {
  const int width = map.width();
  const float z0 = map.depth[v * width + u];
  const Eigen::Vector3f centre = map.points[v * width + u];
  const float gate = same_surface_gate(map.noise, z0) + kGatePerPixel * static_cast<float>(radius);
  const int step = radius > kDenseWindow ? 2 : 1;
  float sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  int count = 0;
  for (int y = std::max(0, v - radius); y <= std::min(map.height() - 1, v + radius); y += step) {
    for (int x = std::max(0, u - radius); x <= std::min(width - 1, u + radius); x += step) {
      const int index = y * width + x;
      if (map.depth[index] <= 0 || std::abs(map.depth[index] - z0) > gate) continue;
      const Eigen::Vector3f d = map.points[index] - centre;
      sx += d.x(), sy += d.y(), sz += d.z();
      xx += d.x() * d.x(), xy += d.x() * d.y(), xz += d.x() * d.z();
      yy += d.y() * d.y(), yz += d.y() * d.z(), zz += d.z() * d.z();
      ++count;
    }
  }
  if (count < kMinNormalPoints) return Eigen::Vector3f::Zero();
  const float n = 1.0f / static_cast<float>(count);
  Eigen::Matrix3f scatter;
  scatter << xx - sx * sx * n, xy - sx * sy * n, xz - sx * sz * n,  //
      xy - sx * sy * n, yy - sy * sy * n, yz - sy * sz * n,         //
      xz - sx * sz * n, yz - sy * sz * n, zz - sz * sz * n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(scatter / scatter.trace());
  Eigen::Vector3f normal = solver.eigenvectors().col(0);
  if (!normal.allFinite()) return Eigen::Vector3f::Zero();
  if (normal.dot(centre) > 0) normal = -normal;
  return normal.normalized();
}

}  // namespace

SurfaceMap surface_map(const Frame& frame, const SurfaceMapOptions& options) {
  SurfaceMap map;
  const std::optional<SensorKind> known = sensor_kind(options.sensor);
  map.sensor = known ? *known : sensor_kind_of(sensor_traits(frame));
  map.noise = noise_of(map.sensor);
  map.reduction = 1;
  while (frame.camera.width / map.reduction > options.max_width && map.reduction < kMaxReduction) {
    ++map.reduction;
  }
  map.camera = reduced_camera(frame.camera, map.reduction);
  const int width = map.width();
  const int size = width * map.height();
  map.depth.resize(size);
  map.points.resize(size);
  map.normals.assign(size, Eigen::Vector3f::Zero());
  map.searched.assign(size, 0);
  parallel_for(map.height(), options.num_threads, [&](int v) {
    for (int u = 0; u < width; ++u) {
      const int i = v * width + u;
      const float z = block_depth(frame, map.noise, u, v, map.reduction);
      map.depth[i] = z;
      map.points[i] = map.camera.unproject(u, v, z).cast<float>();
      map.searched[i] = z > 0 && z <= static_cast<float>(options.max_range_m) &&
                        block_searched(frame, map.noise, u, v, map.reduction, z);
    }
  });
  parallel_for(map.height(), options.num_threads, [&](int v) {
    for (int u = 0; u < width; ++u) {
      const int i = v * width + u;
      if (map.depth[i] <= 0) continue;
      const double pixels = options.normal_radius_m * map.camera.fx / map.depth[i];
      const int radius = std::clamp(static_cast<int>(std::lround(pixels)), kMinWindow, kMaxWindow);
      map.normals[i] = fit_normal(map, u, v, radius);
    }
  });
  return map;
}

}  // namespace bpa
