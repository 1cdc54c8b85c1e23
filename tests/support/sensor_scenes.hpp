// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/infrared_camera.hpp"

// Rectangles before a depth camera of 320 x 240 pixels, whose image is not registered.

namespace bpa::sim {

struct Rectangle {
  double half_width = 20, half_height = 20;  // metres
  Pose camera_from_rectangle;                // faces the camera along its z axis
};

/// `turned` radians about the image's vertical axis.
inline Rectangle wide_plane(double depth, double turned = 0) {
  return {20, 20, {rotation_from_vector(turned * Eigen::Vector3d::UnitY()), {0, 0, depth}}};
}

inline TriangleMesh mesh_of(const Rectangle& r) {
  const auto w = static_cast<float>(r.half_width), h = static_cast<float>(r.half_height);
  TriangleMesh mesh;
  mesh.vertices = {{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

inline SensorImage see(const std::vector<Rectangle>& rectangles, const SensorOptions& options,
                       const Material& material = {}, int num_threads = 2) {
  std::vector<TriangleMesh> meshes;
  std::vector<const TriangleMesh*> pointers;
  std::vector<PosedMesh> posed;
  for (const Rectangle& r : rectangles) {
    meshes.push_back(mesh_of(r));
    posed.push_back({static_cast<int>(posed.size()), r.camera_from_rectangle});
  }
  for (const TriangleMesh& mesh : meshes) pointers.push_back(&mesh);
  const RayMeshes prepared(pointers);
  const RayScene scene(prepared, posed);
  Shading shading;
  shading.materials.assign(rectangles.size(), material);
  const double focal = infrared_focal(options);
  return simulate_sensor({scene, shading, {320, 240, focal, focal, 159.5, 119.5}, Pose{}},
                         unregistered(options), 5, 0, num_threads);
}

inline SensorOptions sensor_of(SensorKind kind) {
  SensorOptions options;
  options.kind = kind;
  return options;
}

/// Mean and standard deviation of measured less true depth, metres, in columns [first, last).
struct DepthError {
  double mean = 0, deviation = 0;
  int count = 0;
};

inline DepthError depth_error(const SensorImage& image, int first, int last) {
  double sum = 0, squares = 0;
  DepthError out;
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    const int x = static_cast<int>(i) % image.frame.camera.width;
    if (x < first || x >= last || image.frame.depth[i] <= 0) continue;
    const double error = image.frame.depth[i] - image.ideal.depth[i];
    sum += error;
    squares += error * error;
    ++out.count;
  }
  out.mean = sum / out.count;
  out.deviation = std::sqrt(squares / out.count - out.mean * out.mean);
  return out;
}

/// The share of a square's true pixels that the measured square has, before a wall.
inline double relative_size(const SensorOptions& options) {
  constexpr double kSquare = 0.8, kWall = 1.2;  // metres away
  const SensorImage image =
      see({wide_plane(kWall), {0.04, 0.04, {Eigen::Quaterniond::Identity(), {0.02, 0, kSquare}}}},
          options);
  const auto near = [](float z) { return z > 0 && z < 0.5 * (kSquare + kWall); };
  const auto measured = std::ranges::count_if(image.frame.depth, near);
  return static_cast<double>(measured) / std::ranges::count_if(image.ideal.depth, near);
}

}  // namespace bpa::sim
