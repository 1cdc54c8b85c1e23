// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/render.hpp"

#include <algorithm>
#include <cmath>

namespace bpa::sim {
namespace {

// `pixel` is the side of a pixel at the distance 1.
Eigen::Vector3f shade(const RayScene& scene, const Shading& shading, const Eigen::Vector3f& origin,
                      const Eigen::Vector3f& direction, const RayHit& hit, float pixel) {
  const Eigen::Vector3f point = origin + hit.distance * direction;
  const Eigen::Vector3f lifted = point + 3e-4f * hit.face_normal;
  const Eigen::Vector3f reflected =
      (direction - 2 * direction.dot(hit.normal) * hit.normal).normalized();
  const Material material = shading.material(hit.instance, {0.7, 0});
  // The sky is brighter than the ground.
  float diffuse = static_cast<float>(shading.ambient) * (0.75f + 0.25f * hit.normal.z());
  float highlight = 0;
  for (const Light& light : shading.lights) {
    const Eigen::Vector3f position = light.position.cast<float>();
    const Eigen::Vector3f to_light = (position - point).normalized();
    const float cosine = hit.normal.dot(to_light);
    if (cosine <= 0 || scene.blocked(lifted, position)) continue;
    const auto power = static_cast<float>(light.power);
    diffuse += power * cosine;
    const float mirror = std::max(0.0f, reflected.dot(to_light));
    highlight += power * static_cast<float>(material.shine) * std::pow(mirror, 40.0f);
  }
  return diffuse * scene.color(hit, pixel * hit.distance) + Eigen::Vector3f::Constant(highlight);
}

// The pixels a mesh's corners span, at most one image beyond each border.
Eigen::AlignedBox2i box_of(const TriangleMesh& mesh, const Pose& camera_from_mesh,
                           const Camera& camera) {
  const Eigen::Vector2d size(camera.width, camera.height);
  const Eigen::AlignedBox2d all(-size, 2 * size - Eigen::Vector2d::Ones());
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d p = camera_from_mesh * vertex.cast<double>();
    if (p.z() < 1e-3) return {all.min().cast<int>(), all.max().cast<int>()};
    box.extend(camera.project(p));
  }
  if (box.isEmpty()) return {};
  box.clamp(all);
  return {box.min().array().floor().cast<int>(), box.max().array().ceil().cast<int>()};
}

}  // namespace

RenderedImage render(const RayScene& scene, const Camera& camera, const Pose& world_from_camera,
                     const std::optional<Shading>& shading, int num_threads) {
  const int count = camera.width * camera.height;
  RenderedImage image;
  image.depth.assign(count, 0);
  image.instance.assign(count, -1);
  image.normals.assign(count, Eigen::Vector3f::Zero());
  if (shading) image.color.assign(3 * count, 0);
  const Eigen::Matrix3f rotation = world_from_camera.matrix().cast<float>();
  const Eigen::Vector3f origin = world_from_camera.translation.cast<float>();
  const auto pixel = static_cast<float>(1 / camera.fx);
  for_each_pixel(camera, num_threads, [&](int x, int y, int i) {
    const Eigen::Vector3f direction =
        rotation * camera.unproject(x, y, 1).cast<float>();  // z = 1: distance is depth
    const std::optional<RayHit> hit = scene.cast(origin, direction);
    if (hit) {
      image.depth[i] = hit->distance;
      image.instance[i] = hit->instance;
      image.normals[i] = rotation.transpose() * hit->normal;
    }
    if (!shading) return;
    const Eigen::Vector3f color = hit ? shade(scene, *shading, origin, direction, *hit, pixel)
                                      : shading->background.cast<float>();
    for (int c = 0; c < 3; ++c) {
      image.color[3 * i + c] =
          static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[c], 0.0f, 1.0f)));
    }
  });
  return image;
}

std::vector<InstanceVisibility> visibility(const RayScene& scene, const RenderedImage& image,
                                           const Camera& camera, const Pose& world_from_camera,
                                           int num_instances, int num_threads) {
  std::vector<InstanceVisibility> result(num_instances);
  for (const std::int32_t instance : image.instance) {
    if (instance >= 0 && instance < num_instances) ++result[instance].visible_pixels;
  }
  parallel_for(num_instances, num_threads, [&](int i) {
    const PosedMesh& posed = scene.instances()[i];
    const Pose mesh_from_camera = posed.world_from_mesh.inverse() * world_from_camera;
    const Eigen::AlignedBox2i box =
        box_of(scene.meshes().mesh(posed.mesh), mesh_from_camera.inverse(), camera);
    const Eigen::Matrix3f rotation = mesh_from_camera.matrix().cast<float>();
    const Eigen::Vector3f origin = mesh_from_camera.translation.cast<float>();
    for (int y = box.min().y(); y <= box.max().y(); ++y) {
      for (int x = box.min().x(); x <= box.max().x(); ++x) {
        const Eigen::Vector3f direction = rotation * camera.unproject(x, y, 1).cast<float>();
        result[i].all_pixels += scene.meshes().hits(posed.mesh, origin, direction);
      }
    }
    // Rounding may differ by a pixel between the two frames.
    result[i].all_pixels = std::max(result[i].all_pixels, result[i].visible_pixels);
  });
  return result;
}

}  // namespace bpa::sim
