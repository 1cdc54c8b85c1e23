// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/mesh_file.hpp"

#include <filesystem>

#include "core/io/file_bytes.hpp"
#include "core/io/pcd_file.hpp"
#include "core/io/private/mesh_assimp.hpp"

namespace bpa::io {
namespace {

Status check_finite(const TriangleMesh& mesh, const std::string& path) {
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    if (!vertex.allFinite()) {
      return Status(StatusCode::corrupt, path + " has a vertex that is not finite");
    }
  }
  return {};
}

PointCloud finite_points(const TriangleMesh& mesh) {
  PointCloud cloud;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) continue;
    cloud.points.push_back(mesh.vertices[i]);
    if (!mesh.normals.empty()) cloud.normals.push_back(mesh.normals[i]);
    if (!mesh.colors.empty()) cloud.colors.push_back(mesh.colors[i]);
  }
  return cloud;
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::string& path, double scale) {
  const std::string extension = lower_extension(path);
  Result<TriangleMesh> mesh = Status(
      StatusCode::unsupported, path + " is not a mesh that can be read; use .ply, .obj or .stl");
  if (extension == "ply") {
    const Result<std::string> bytes = read_file(path);
    if (!bytes.ok()) return bytes.status();
    mesh = parse_ply(*bytes, path, scale);
  } else if (extension == "obj" || extension == "stl") {
    if (!std::filesystem::is_regular_file(path)) {
      return Status(StatusCode::not_found, path + " cannot be opened");
    }
    mesh = read_mesh_with_assimp(path);
    if (!mesh.ok()) return mesh;
    for (Eigen::Vector3f& vertex : mesh->vertices) {
      vertex = (scale * vertex.cast<double>()).cast<float>();
    }
  }
  if (!mesh.ok()) return mesh;
  if (Status status = check_finite(*mesh, path); !status.ok() && !mesh->triangles.empty()) {
    return status;
  }
  return mesh;
}

Result<PointCloud> read_point_cloud(const std::string& path, double scale) {
  if (lower_extension(path) == "pcd") {
    Result<PcdCloud> pcd = read_pcd(path);
    if (!pcd.ok()) return pcd.status();
    return drop_invalid_points(*pcd, scale);
  }
  if (lower_extension(path) != "ply") {
    return Status(StatusCode::unsupported,
                  path + " is not a point cloud that can be read; use .ply or .pcd");
  }
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  const Result<TriangleMesh> mesh = parse_ply(*bytes, path, scale);
  if (!mesh.ok()) return mesh.status();
  return finite_points(*mesh);
}

}  // namespace bpa::io
