// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>

#if __has_include(<embree4/rtcore.h>)  // Debian 13
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "core/cloud/texture.hpp"
#include "core/sim/render.hpp"

namespace bpa::sim {
namespace {

RTCRay ray_of(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far) {
  constexpr float kTime = 0;
  constexpr unsigned kMask = ~0u;
  return {
      origin.x(), origin.y(), origin.z(), near, direction.x(), direction.y(), direction.z(), kTime,
      far,        kMask,      0,          0};
}

/// rtcIntersect1 or rtcOccluded1 by either version's signature.
template <auto Function, class Query>
void ask(RTCScene scene, Query& query) {
#if RTC_VERSION_MAJOR >= 4
  Function(scene, &query, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  Function(scene, &context, &query);
#endif
}

bool hits_anything(RTCScene scene, RTCRay ray) {
  ask<rtcOccluded1>(scene, ray);
  return ray.tfar < 0;
}

/// Three numbers of four bytes for each item.
template <class Item>
void set_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                const std::vector<Item>& items) {
  static_assert(sizeof(Item) == 12);
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(Item), items.size());
  std::copy(items.begin(), items.end(), static_cast<Item*>(buffer));
}

RTCScene scene_of(RTCDevice device, const TriangleMesh& mesh) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  set_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices);
  set_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace

RayMeshes::RayMeshes(const std::vector<const TriangleMesh*>& meshes)
    // Trees are built by the caller's thread alone.
    : meshes_(meshes), device_(rtcNewDevice("threads=1"), rtcReleaseDevice) {
  for (const TriangleMesh* mesh : meshes) {
    scenes_.emplace_back(scene_of(device_.get(), *mesh), rtcReleaseScene);
  }
}

bool RayMeshes::hits(int mesh, const Eigen::Vector3f& origin,
                     const Eigen::Vector3f& direction) const {
  return hits_anything(scenes_[mesh].get(),
                       ray_of(origin, direction, 0, std::numeric_limits<float>::infinity()));
}

RayScene::RayScene(const RayMeshes& meshes, std::vector<PosedMesh> instances)
    : meshes_(&meshes),
      instances_(std::move(instances)),
      scene_(rtcNewScene(meshes.device_.get()), rtcReleaseScene) {
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    RTCGeometry geometry = rtcNewGeometry(meshes.device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, meshes.scenes_[instances_[i].mesh].get());
    rtcSetGeometryTimeStepCount(geometry, 1);
    Eigen::Matrix<float, 3, 4> transform;
    transform.leftCols<3>() = instances_[i].world_from_mesh.matrix().cast<float>();
    transform.col(3) = instances_[i].world_from_mesh.translation.cast<float>();
    rotations_.push_back(transform.leftCols<3>());
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_.get());
}

std::optional<RayHit> RayScene::cast(const Eigen::Vector3f& origin,
                                     const Eigen::Vector3f& direction) const {
  RTCRayHit query{};
  query.ray = ray_of(origin, direction, 0, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  ask<rtcIntersect1>(scene_.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  RayHit hit;
  hit.distance = query.ray.tfar;
  hit.instance = static_cast<int>(query.hit.instID[0]);
  const TriangleMesh& mesh = meshes_->mesh(instances_[hit.instance].mesh);
  const auto& triangle = mesh.triangles[query.hit.primID];
  const std::array<float, 3> weight{1 - query.hit.u - query.hit.v, query.hit.u, query.hit.v};
  const Eigen::Vector3f& a = mesh.vertices[triangle[0]];
  const Eigen::Vector3f edge = mesh.vertices[triangle[1]] - a;
  hit.face_normal = edge.cross(mesh.vertices[triangle[2]] - a).normalized();
  hit.normal = hit.face_normal;
  hit.triangle = query.hit.primID;
  hit.weights = {query.hit.u, query.hit.v};
  if (!mesh.normals.empty()) {
    hit.normal.setZero();
    for (int k = 0; k < 3; ++k) hit.normal += weight[k] * mesh.normals[triangle[k]];
    hit.normal.normalize();
  }
  for (Eigen::Vector3f* normal : {&hit.normal, &hit.face_normal}) {
    *normal = rotations_[hit.instance] * *normal;
    if (normal->dot(direction) > 0) *normal = -*normal;
  }
  return hit;
}

Eigen::Vector3f RayScene::color(const RayHit& hit, float side) const {
  const TriangleMesh& mesh = meshes_->mesh(instances_[hit.instance].mesh);
  if (!mesh.textures.empty()) return color_at(mesh, hit.triangle, hit.weights, side) / 255;
  if (mesh.colors.empty()) return Eigen::Vector3f::Constant(0.6f);
  // The sum of color_at() in another order, which keeps simulated frames the same to the bit.
  const float weight[] = {1 - hit.weights.x() - hit.weights.y(), hit.weights.x(), hit.weights.y()};
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto& c = mesh.colors[mesh.triangles[hit.triangle][k]];
    color += weight[k] / 255 * Eigen::Vector3f(c[0], c[1], c[2]);
  }
  return color;
}

bool RayScene::blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  const Eigen::Vector3f direction = to - from;
  const float margin = 2e-4f / direction.norm();
  return hits_anything(scene_.get(), ray_of(from, direction, margin, 1 - margin));
}

}  // namespace bpa::sim
