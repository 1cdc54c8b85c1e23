// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

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

RTCRay ray_between(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const Eigen::Vector3f direction = to - from;
  const float margin = 2e-4f / direction.norm();
  return ray_of(from, direction, margin, 1 - margin);
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

// A packet of rays, and which of its lanes hold one.
constexpr std::size_t kPacket = 8;
struct alignas(32) Lanes {
  std::array<int, kPacket> valid{};

  explicit Lanes(std::size_t count) { std::fill_n(valid.begin(), std::min(count, kPacket), -1); }
};

void set_lane(RTCRay8& rays, std::size_t lane, const RTCRay& ray) {
  rays.org_x[lane] = ray.org_x, rays.org_y[lane] = ray.org_y, rays.org_z[lane] = ray.org_z;
  rays.dir_x[lane] = ray.dir_x, rays.dir_y[lane] = ray.dir_y, rays.dir_z[lane] = ray.dir_z;
  rays.tnear[lane] = ray.tnear, rays.tfar[lane] = ray.tfar;
  rays.time[lane] = ray.time, rays.mask[lane] = ray.mask;
  rays.id[lane] = ray.id, rays.flags[lane] = ray.flags;
}

/// rtcIntersect8 or rtcOccluded8 of rays that are close together, by either version's signature.
template <auto Function, class Query>
void ask_packet(RTCScene scene, const Lanes& lanes, Query& query) {
#if RTC_VERSION_MAJOR >= 4
  std::conditional_t<std::is_same_v<Query, RTCRayHit8>, RTCIntersectArguments, RTCOccludedArguments>
      arguments;
  if constexpr (std::is_same_v<Query, RTCRayHit8>) {
    rtcInitIntersectArguments(&arguments);
  } else {
    rtcInitOccludedArguments(&arguments);
  }
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  Function(lanes.valid.data(), scene, &query, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Function(lanes.valid.data(), scene, &context, &query);
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
  return hit_at(query.ray.tfar, query.hit.instID[0], query.hit.primID, {query.hit.u, query.hit.v},
                direction);
}

std::vector<std::optional<RayHit>> RayScene::cast(
    const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> directions) const {
  std::vector<std::optional<RayHit>> out(directions.size());
  for (std::size_t first = 0; first < directions.size(); first += kPacket) {
    const Lanes lanes(directions.size() - first);
    RTCRayHit8 query{};
    for (std::size_t k = 0; k < kPacket && first + k < directions.size(); ++k) {
      set_lane(query.ray, k,
               ray_of(origin, directions[first + k], 0, std::numeric_limits<float>::infinity()));
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    ask_packet<rtcIntersect8>(scene_.get(), lanes, query);
    for (std::size_t k = 0; k < kPacket && first + k < directions.size(); ++k) {
      if (query.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
      out[first + k] = hit_at(query.ray.tfar[k], query.hit.instID[0][k], query.hit.primID[k],
                              {query.hit.u[k], query.hit.v[k]}, directions[first + k]);
    }
  }
  return out;
}

RayHit RayScene::hit_at(float distance, std::uint32_t instance, std::uint32_t triangle_index,
                        const Eigen::Vector2f& weights, const Eigen::Vector3f& direction) const {
  RayHit hit;
  hit.distance = distance;
  hit.instance = static_cast<int>(instance);
  const TriangleMesh& mesh = meshes_->mesh(instances_[hit.instance].mesh);
  const auto& triangle = mesh.triangles[triangle_index];
  const std::array<float, 3> weight{1 - weights.x() - weights.y(), weights.x(), weights.y()};
  const Eigen::Vector3f& a = mesh.vertices[triangle[0]];
  const Eigen::Vector3f edge = mesh.vertices[triangle[1]] - a;
  hit.face_normal = edge.cross(mesh.vertices[triangle[2]] - a).normalized();
  hit.normal = hit.face_normal;
  hit.triangle = triangle_index;
  hit.weights = weights;
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
  return hits_anything(scene_.get(), ray_between(from, to));
}

std::vector<std::uint8_t> RayScene::blocked(std::span<const Eigen::Vector3f> from,
                                            const Eigen::Vector3f& to) const {
  std::vector<std::uint8_t> out(from.size());
  for (std::size_t first = 0; first < from.size(); first += kPacket) {
    const Lanes lanes(from.size() - first);
    RTCRay8 rays{};
    for (std::size_t k = 0; k < kPacket && first + k < from.size(); ++k) {
      set_lane(rays, k, ray_between(from[first + k], to));
    }
    ask_packet<rtcOccluded8>(scene_.get(), lanes, rays);
    for (std::size_t k = 0; k < kPacket && first + k < from.size(); ++k) {
      out[first + k] = rays.tfar[k] < 0;
    }
  }
  return out;
}

}  // namespace bpa::sim
