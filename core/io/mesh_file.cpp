// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/pcd_file.hpp"

namespace bpa::io {
namespace {

Eigen::Vector3f to_eigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
}

void append_mesh(const aiMesh& part, bool normals, bool colors, double scale, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const Eigen::Vector3f vertex = to_eigen(part.mVertices[i]);
    mesh.vertices.push_back((scale * vertex.cast<double>()).cast<float>());
    if (normals) mesh.normals.push_back(to_eigen(part.mNormals[i]).stableNormalized());
    if (colors) {
      const aiColor4D& c = part.mColors[0][i];
      mesh.colors.push_back({to_byte(c.r), to_byte(c.g), to_byte(c.b)});
    }
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    mesh.triangles.push_back(
        {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

/// Reads OBJ and STL.
Result<TriangleMesh> read_with_assimp(const std::string& path, double scale) {
  if (!std::filesystem::is_regular_file(path)) return not_found(path, " cannot be opened");
  try {
    Assimp::Importer importer;
    const aiScene* scene =
        importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                    aiProcess_PreTransformVertices);
    if (!scene) return corrupt(path, " cannot be read: ", importer.GetErrorString());
    const auto all = [scene](auto has) {
      return std::all_of(scene->mMeshes, scene->mMeshes + scene->mNumMeshes, has);
    };
    const bool normals = all([](const aiMesh* part) { return part->HasNormals(); });
    const bool colors = all([](const aiMesh* part) { return part->HasVertexColors(0); });
    TriangleMesh mesh;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
      append_mesh(*scene->mMeshes[i], normals, colors, scale, mesh);
    }
    return mesh;
  } catch (const std::exception& error) {
    return corrupt(path, " cannot be read: ", error.what());
  }
}

Result<TriangleMesh> read_ply(const std::string& path, double scale) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  return parse_ply(*bytes, path, scale);
}

}  // namespace

Result<TriangleMesh> read_mesh(const std::string& path, double scale) {
  const std::string extension = lower_extension(path);
  const bool ply = extension == "ply";
  if (!ply && extension != "obj" && extension != "stl") {
    return Status(StatusCode::unsupported,
                  path + " is not a mesh that can be read; use .ply, .obj or .stl");
  }
  Result<TriangleMesh> mesh = ply ? read_ply(path, scale) : read_with_assimp(path, scale);
  if (!mesh.ok() || mesh->triangles.empty()) return mesh;
  const bool finite =
      std::ranges::all_of(mesh->vertices, [](const auto& v) { return v.allFinite(); });
  if (!finite) return corrupt(path, " has a vertex that is not finite");
  return mesh;
}

Result<PointCloud> read_point_cloud(const std::string& path, double scale) {
  const std::string extension = lower_extension(path);
  if (extension == "pcd") {
    const Result<PcdCloud> pcd = read_pcd(path);
    if (!pcd.ok()) return pcd.status();
    return drop_invalid_points(*pcd, scale);
  }
  if (extension != "ply") {
    return Status(StatusCode::unsupported,
                  path + " is not a point cloud that can be read; use .ply or .pcd");
  }
  Result<TriangleMesh> mesh = read_ply(path, scale);
  if (!mesh.ok()) return mesh.status();
  PointCloud cloud;
  cloud.points = std::move(mesh->vertices);
  cloud.normals = std::move(mesh->normals);
  cloud.colors = std::move(mesh->colors);
  return drop_invalid_points(cloud);
}

}  // namespace bpa::io
