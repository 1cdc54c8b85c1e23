// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"
#include "core/sim/objects.hpp"

// Ray casting of posed meshes (Embree).

struct RTCDeviceTy;
struct RTCSceneTy;

namespace bpa::sim {

/// Where a ray meets a surface first.
struct RayHit {
  float distance = 0;           ///< In units of the ray's direction vector.
  int instance = -1;            ///< Index of the posed mesh.
  Eigen::Vector3f normal;       ///< Unit length, toward the ray's origin; smooth if the mesh's are.
  Eigen::Vector3f face_normal;  ///< Of the triangle, toward the ray's origin.
  std::uint32_t triangle = 0;   ///< Index in the mesh.
  Eigen::Vector2f weights;      ///< Barycentric, of the triangle's second and third corner.
};

/// Meshes prepared for ray casting, to be posed in any number of scenes. They must outlive it.
class RayMeshes {
 public:
  explicit RayMeshes(const std::vector<const TriangleMesh*>& meshes);

  int size() const { return static_cast<int>(meshes_.size()); }
  const TriangleMesh& mesh(int index) const { return *meshes_[index]; }
  /// Whether a ray in the frame of one mesh meets it.
  bool hits(int mesh, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  friend class RayScene;
  std::vector<const TriangleMesh*> meshes_;
  std::shared_ptr<RTCDeviceTy> device_;
  std::vector<std::shared_ptr<RTCSceneTy>> scenes_;  // one for each mesh
};

/// One mesh standing in the world.
struct PosedMesh {
  int mesh = 0;  ///< Index in RayMeshes.
  Pose world_from_mesh;
};

/// An immutable arrangement of meshes. Safe to use from many threads; `meshes` must outlive it.
class RayScene {
 public:
  RayScene(const RayMeshes& meshes, std::vector<PosedMesh> instances);

  const std::vector<PosedMesh>& instances() const { return instances_; }
  const RayMeshes& meshes() const { return *meshes_; }

  /// The first surface along the ray, seen from either side.
  std::optional<RayHit> cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;
  /// The same of many rays from one point, in their order: takes a third of the time where
  /// neighbours are close together.
  std::vector<std::optional<RayHit>> cast(const Eigen::Vector3f& origin,
                                          std::span<const Eigen::Vector3f> directions) const;
  /// rgb in [0, 1], averaged over a square of `side` metres; grey for a mesh without colours.
  Eigen::Vector3f color(const RayHit& hit, float side) const;
  /// Whether a surface lies between two points, except in the first and last 0.2 mm.
  bool blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;
  /// The same of many points `from`, in their order: 1 where a surface lies between. As quick.
  std::vector<std::uint8_t> blocked(std::span<const Eigen::Vector3f> from,
                                    const Eigen::Vector3f& to) const;

 private:
  RayHit hit_at(float distance, std::uint32_t instance, std::uint32_t triangle,
                const Eigen::Vector2f& weights, const Eigen::Vector3f& direction) const;

  const RayMeshes* meshes_;
  std::vector<PosedMesh> instances_;
  std::vector<Eigen::Matrix3f> rotations_;  // world from mesh, of the instances
  std::shared_ptr<RTCSceneTy> scene_;
};

/// What an ideal camera sees, row-major.
struct RenderedImage {
  std::vector<float> depth;              ///< Metres along z; 0 where there is nothing.
  std::vector<std::int32_t> instance;    ///< Index of the posed mesh; -1 where there is nothing.
  std::vector<Eigen::Vector3f> normals;  ///< In the camera's frame.
  std::vector<std::uint8_t> color;       ///< rgb, shaded; empty if not asked for.
};

/// A lamp of the scene.
struct Light {
  Eigen::Vector3d position{0.5, -0.5, 2.0};  ///< World, metres.
  double power = 0.6;                        ///< Of a white surface facing it.
};

/// How colours are made: ambient light, lamps with shadows, a highlight by the material's shine.
struct Shading {
  std::vector<Light> lights{{}};
  double ambient = 0.4;
  std::vector<Material> materials;  ///< By posed mesh; those beyond its end are matt.
  Eigen::Vector3d background{0.05, 0.05, 0.05};

  /// The material of a posed mesh, or `other` beyond the end of `materials`.
  const Material& material(int instance, const Material& other) const {
    const auto index = static_cast<std::size_t>(instance);
    return index < materials.size() ? materials[index] : other;
  }
};

/// Calls visit(x, y, index) for every pixel of a row-major image; threads share its rows.
void for_each_pixel(const Camera& camera, int num_threads, const auto& visit) {
  parallel_for(camera.height, num_threads, [&](int y) {
    for (int x = 0; x < camera.width; ++x) visit(x, y, y * camera.width + x);
  });
}

/// One ray through every pixel centre. The same for any number of threads.
RenderedImage render(const RayScene& scene, const Camera& camera, const Pose& world_from_camera,
                     const std::optional<Shading>& shading, int num_threads = 0);

/// How much of one posed mesh an image shows.
struct InstanceVisibility {
  int visible_pixels = 0;
  int all_pixels = 0;  ///< If it stood alone and the image went on beyond its border.

  double fraction() const { return all_pixels > 0 ? double(visible_pixels) / all_pixels : 0; }
};

/// Counts for every posed mesh; `image` is of the same scene and camera. As BOP defines it, the
/// whole silhouette counts, within an image three times as wide and high.
std::vector<InstanceVisibility> visibility(const RayScene& scene, const RenderedImage& image,
                                           const Camera& camera, const Pose& world_from_camera,
                                           int num_instances, int num_threads = 0);

}  // namespace bpa::sim
