// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/telltales.hpp"

#include <algorithm>
#include <numeric>

namespace bpa::sim {
namespace {

constexpr int kChecked = 500;  // vertices at most

/// Vertices in sight, as a share of those asked for.
double share_in_sight(const SimulatedObject& object, const std::vector<int>& vertices,
                      const RayScene& scene, const Camera& camera, const Pose& world_from_camera) {
  const Pose world_from_object = scene.instances().front().world_from_mesh;
  const Pose camera_from_object = world_from_camera.inverse() * world_from_object;
  const Eigen::Vector3f eye = world_from_camera.translation.cast<float>();
  const std::size_t step = vertices.size() / kChecked + 1;
  int seen = 0, checked = 0;
  for (std::size_t i = 0; i < vertices.size(); i += step, ++checked) {
    const Eigen::Vector3d vertex = object.mesh.vertices[vertices[i]].cast<double>();
    const Eigen::Vector3d in_camera = camera_from_object * vertex;
    if (in_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    const bool inside = pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < camera.width - 0.5 &&
                        pixel.y() < camera.height - 0.5;
    seen += inside && !scene.blocked(eye, (world_from_object * vertex).cast<float>());
  }
  return checked > 0 ? static_cast<double>(seen) / checked : 0;
}

}  // namespace

bool telltales_hidden(const SimulatedObject& object, const RayScene& scene, const Camera& camera,
                      const Pose& world_from_camera) {
  constexpr double kEnough = 0.1;  // half of the outside of a vessel is some 0.25
  std::vector<int> all(object.mesh.vertices.size());
  std::iota(all.begin(), all.end(), 0);
  return share_in_sight(object, object.telltales, scene, camera, world_from_camera) == 0 &&
         share_in_sight(object, all, scene, camera, world_from_camera) > kEnough;
}

}  // namespace bpa::sim
