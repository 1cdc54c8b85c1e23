// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "core/base/concat.hpp"
#include "core/cloud/texture.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/private/byte_stream.hpp"

namespace bpa::io {
namespace {

std::string header_of(const TriangleMesh& mesh, const std::vector<std::string>& textures,
                      bool numbered) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& name : textures) text += "comment TextureFile " + name + "\n";
  text += concat("element vertex ", mesh.vertices.size(),
                 "\nproperty float x\nproperty float y\nproperty float z\n");
  if (!mesh.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.colors.empty()) {
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  if (!textures.empty()) text += "property float texture_u\nproperty float texture_v\n";
  if (!mesh.triangles.empty()) {
    text += concat("element face ", mesh.triangles.size(),
                   "\nproperty list uchar int vertex_indices\n");
    if (numbered) text += "property int texnumber\n";
  }
  return text + "end_header\n";
}

std::string bytes_of(const TriangleMesh& mesh, double scale,
                     const std::vector<std::string>& textures) {
  // As BOP has them, unless there is more than one texture: then as MeshLab does.
  const bool numbered =
      !textures.empty() && std::ranges::any_of(mesh.texture_of, [](int k) { return k != 0; });
  std::string bytes = header_of(mesh, textures, numbered);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f scaled = (scale * mesh.vertices[i].cast<double>()).cast<float>();
    append(bytes, scaled);
    if (!mesh.normals.empty()) append(bytes, mesh.normals[i]);
    if (!mesh.colors.empty()) append(bytes, mesh.colors[i]);
    if (!textures.empty()) append(bytes, mesh.uv[i]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(bytes, std::uint8_t{3});
    append(bytes, mesh.triangles[t]);
    if (numbered) append(bytes, mesh.texture_of[t]);
  }
  return bytes;
}

Status write_texture(const std::string& path, const RgbImage& image) {
  ColorImage out{image.width, image.height, {}};
  for (const auto& rgb : image.pixels) out.pixels.insert(out.pixels.end(), rgb.begin(), rgb.end());
  return write_color_png(path, out);
}

}  // namespace

std::string ply_bytes(const TriangleMesh& mesh, double scale) { return bytes_of(mesh, scale, {}); }

std::string ply_bytes(const PointCloud& cloud, double scale) {
  TriangleMesh mesh;
  mesh.vertices = cloud.points;
  mesh.normals = cloud.normals;
  mesh.colors = cloud.colors;
  return bytes_of(mesh, scale, {});
}

Status write_ply(const std::string& path, const TriangleMesh& mesh, double scale) {
  const std::filesystem::path file(path);
  std::vector<std::string> names;
  for (const std::shared_ptr<const Texture>& texture : mesh.textures) {
    const std::string number = names.empty() ? "" : concat("_", names.size());
    names.push_back(file.stem().string() + number + ".png");
    const std::string image = (file.parent_path() / names.back()).string();
    if (Status s = write_texture(image, texture->levels.front()); !s.ok()) return s;
  }
  return write_file(path, bytes_of(mesh, scale, names));
}

Status write_ply(const std::string& path, const PointCloud& cloud, double scale) {
  return write_file(path, ply_bytes(cloud, scale));
}

}  // namespace bpa::io
