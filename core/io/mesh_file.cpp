// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "core/base/concat.hpp"
#include "core/cloud/normals.hpp"
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
  if (!ply.unread_color.empty() && ply.textures.empty()) {
    drop_colors("has colours in " + ply.unread_color + ", which is not read", file);
  }
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

/// Leaves one of triangles that have the same corners, in the same order round the triangle: each
/// copy would count as surface.
void drop_copies(TriangleMesh& mesh) {
  using Corners = std::array<std::array<float, 3>, 3>;
  std::vector<std::pair<Corners, std::size_t>> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& v = mesh.vertices[mesh.triangles[t][k]];
      corners[k] = {v.x(), v.y(), v.z()};
    }
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    all.emplace_back(corners, t);
  }
  std::ranges::sort(all);
  std::vector<std::uint8_t> copy(all.size(), 0);
  for (std::size_t i = 1; i < all.size(); ++i)
    copy[all[i].second] = all[i].first == all[i - 1].first;
  const bool textured = !mesh.texture_of.empty();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < copy.size(); ++t) {
    if (copy[t] != 0) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    if (textured) mesh.texture_of[kept] = mesh.texture_of[t];
    ++kept;
  }
  mesh.triangles.resize(kept);
  if (textured) mesh.texture_of.resize(kept);
}

/// The first mesh of a URDF or SDF; an included model is none.
std::string mesh_named_in(const std::string& text) {
  for (std::size_t at = 0; (at = text.find("<mesh", at)) != text.npos; ++at) {
    const std::size_t end = text.find('>', at);
    const std::size_t attribute = text.find("filename", at);
    std::size_t from = text.find("<uri>", at);
    const char* close = "<";
    if (attribute < end) {
      from = text.find_first_of("\"'", attribute);
      if (from == text.npos) continue;
      close = text[from] == '"' ? "\"" : "'";
    } else if (from > text.find("</mesh>", at)) {
      continue;
    }
    from += attribute < end ? 1 : std::string_view("<uri>").size();
    return text.substr(from, text.find(close, from) - from);
  }
  return "";
}

/// How a file of another format becomes a mesh.
std::string way_to_a_mesh(const std::string& path, const std::string& extension) {
  const auto is = [&](std::initializer_list<const char*> all) {
    return std::ranges::count(all, extension) > 0;
  };
  const std::string to = std::filesystem::path(path).stem().string() + ".stl";
  if (is({"step", "stp", "iges", "igs", "brep"})) {
    return "; mesh it: freecadcmd -c \"import Part, MeshPart; "
           "MeshPart.meshFromShape(Shape=Part.read('" +
           path + "'), LinearDeflection=0.1).write('" + to + "')\"";
  }
  if (is({"3mf", "fbx", "3ds", "x3d", "blend", "off", "amf", "dxf"})) {
    return "; convert it: assimp export " + path + ' ' + to;
  }
  if (is({"usd", "usda", "usdc", "usdz"})) return "; export it from Blender as GLB";
  if (is({"wrl", "vrml"})) return "; export it from MeshLab as PLY";
  if (is({"sldprt", "sldasm", "ipt", "iam", "f3d", "prt", "catpart", "jt", "3dm", "x_t", "dwg"})) {
    return "; export it as STL or GLB from the CAD program that wrote it";
  }
  if (!is({"sdf", "urdf", "xacro"})) return "";
  const Result<std::string> text = read_file(path);
  const std::string named = text.ok() ? mesh_named_in(*text) : "";
  return "; give the mesh that it names" + (named.empty() ? "" : ": " + named);
}

/// A name that promises another content than there is would end in the words of its parser.
Status check_content(const std::string& path, const std::string& extension) {
  std::string head(32, '\0');
  std::ifstream(path, std::ios::binary).read(head.data(), std::ssize(head));
  const std::string content = content_of(head);
  if (content.empty() || (extension == "ply" && content == "a PLY file") ||
      (extension == "glb" && content == "a GLB file")) {
    return {};
  }
  const bool step = content == "a STEP file";
  return Status(StatusCode::unsupported, path + " is not what its name says, but " + content +
                                             (step ? way_to_a_mesh(path, "step") : ""));
}

Result<MeshFile> read_any(const std::string& path, double scale, bool colored) {
  const std::string extension = lower_extension(path);
  if (std::ranges::count(mesh_extensions(), extension) == 0) {
    return Status(StatusCode::unsupported,
                  path +
                      " is not a mesh that can be read; use .ply, .obj, .stl, .glb, .gltf or "
                      ".dae" +
                      way_to_a_mesh(path, extension));
  }
  if (Status status = check_content(path, extension); !status.ok()) return status;
  Result<MeshFile> file = MeshFile{};
  if (extension == "ply") {
    Result<PlyFile> ply = read_ply(path, scale);
    if (!ply.ok()) return ply.status();
    if (!colored) {
      clear_textures(ply->mesh);
      ply->textures.clear();
      ply->unread_color.clear();
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
  drop_copies(file->mesh);
  mend_normals(file->mesh);
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
