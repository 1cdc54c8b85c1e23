// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/mesh_file.hpp"

#include <algorithm>
#include <filesystem>

#include "core/base/concat.hpp"
#include "core/cloud/texture.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/pcd_file.hpp"
#include "core/io/private/mesh_parts.hpp"
#include "core/io/private/texture_files.hpp"

namespace bpa::io {
namespace {

Result<PlyFile> read_ply(const std::string& path, double scale) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  return parse_ply_file(*bytes, path, scale);
}

/// Leaves the colours of the vertices, if there are any.
void drop_textures(const std::string& reason, MeshFile& file) {
  if (file.mesh.colors.empty()) return drop_colors(reason, file);
  clear_textures(file.mesh);
  file.warnings.push_back(reason + ": the colours of the vertices are used");
}

/// The texture of a PLY file replaces the colours of its vertices, as in BOP's renderer.
MeshFile with_textures(PlyFile ply, const std::string& path) {
  MeshFile file{std::move(ply.mesh), {}, false};
  TriangleMesh& mesh = file.mesh;
  if (mesh.uv.empty() && ply.textures.empty()) return file;
  if (mesh.uv.empty() || ply.textures.empty()) {
    const char* reason = mesh.uv.empty() ? "names a texture, but has no texture coordinates"
                                         : "has texture coordinates, but names no texture";
    drop_textures(reason, file);
    return file;
  }
  TextureFiles textures(path);
  std::vector<int> indices;  // a file may be named twice
  for (const std::string& name : ply.textures) {
    TextureReference reference;
    reference.name = name;
    const Result<int> index = textures.add(reference, mesh);
    if (!index.ok()) {
      drop_textures(index.status().message, file);
      return file;
    }
    indices.push_back(*index);
  }
  for (int& k : mesh.texture_of) {
    k = k >= 0 && k < static_cast<int>(indices.size()) ? indices[static_cast<std::size_t>(k)] : -1;
  }
  if (std::ranges::count(mesh.texture_of, -1) == 0) {
    mesh.colors.clear();
  } else if (mesh.colors.empty()) {
    drop_colors("has triangles without texture", file);
  }
  return file;
}

Result<MeshFile> read_any(const std::string& path, double scale, bool colored) {
  const std::string extension = lower_extension(path);
  if (std::ranges::count(mesh_extensions(), extension) == 0) {
    return Status(StatusCode::unsupported,
                  path +
                      " is not a mesh that can be read; use .ply, .obj, .stl, .glb, .gltf or "
                      ".dae");
  }
  Result<MeshFile> file = MeshFile{};
  if (extension == "ply") {
    Result<PlyFile> ply = read_ply(path, scale);
    if (!ply.ok()) return ply.status();
    if (!colored) {
      clear_textures(ply->mesh);
      ply->textures.clear();
    }
    file = with_textures(std::move(*ply), path);
  } else {
    file = read_with_assimp(path, scale, colored);
  }
  if (!file.ok() || file->mesh.triangles.empty()) return file;
  const auto finite = [](const auto& v) { return v.allFinite(); };
  if (!std::ranges::all_of(file->mesh.vertices, finite)) {
    return corrupt(path, " has a vertex that is not finite");
  }
  if (!std::ranges::all_of(file->mesh.uv, finite)) {
    drop_colors("has texture coordinates that are not finite", *file);
  }
  return file;
}

}  // namespace

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> extensions{"ply", "obj", "stl", "glb", "gltf", "dae"};
  return extensions;
}

void drop_colors(const std::string& reason, MeshFile& file) {
  file.mesh.colors.clear();
  clear_textures(file.mesh);
  file.warnings.push_back(reason + ": the model has no colour");
}

Result<MeshFile> read_mesh_file(const std::string& path, double scale) {
  return read_any(path, scale, true);
}

Result<TriangleMesh> read_mesh(const std::string& path, double scale) {
  Result<MeshFile> file = read_any(path, scale, false);
  if (!file.ok()) return file.status();
  return std::move(file->mesh);
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
  Result<PlyFile> ply = read_ply(path, scale);
  if (!ply.ok()) return ply.status();
  PointCloud cloud;
  cloud.points = std::move(ply->mesh.vertices);
  cloud.normals = std::move(ply->mesh.normals);
  cloud.colors = std::move(ply->mesh.colors);
  return drop_invalid_points(cloud);
}

}  // namespace bpa::io
