// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include "core/io/file_bytes.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/private/byte_stream.hpp"

namespace bpa::io {
namespace {

using Colors = std::vector<std::array<std::uint8_t, 3>>;
using Vectors = std::vector<Eigen::Vector3f>;

std::string header(std::size_t vertices, bool normals, bool colors, std::size_t triangles) {
  std::ostringstream text;
  text << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices
       << "\nproperty float x\nproperty float y\nproperty float z\n";
  if (normals) text << "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors) text << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (triangles > 0) {
    text << "element face " << triangles << "\nproperty list uchar int vertex_indices\n";
  }
  text << "end_header\n";
  return text.str();
}

void append_vertices(std::string& bytes, const Vectors& points, const Vectors& normals,
                     const Colors& colors, double scale) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f point =
        scale == 1.0 ? points[i] : (scale * points[i].cast<double>()).cast<float>();
    for (int k = 0; k < 3; ++k) append(bytes, point[k]);
    for (int k = 0; k < 3 && !normals.empty(); ++k) append(bytes, normals[i][k]);
    for (std::size_t k = 0; k < 3 && !colors.empty(); ++k) append(bytes, colors[i][k]);
  }
}

}  // namespace

std::string ply_bytes(const TriangleMesh& mesh, double scale) {
  std::string bytes = header(mesh.vertices.size(), !mesh.normals.empty(), !mesh.colors.empty(),
                             mesh.triangles.size());
  append_vertices(bytes, mesh.vertices, mesh.normals, mesh.colors, scale);
  for (const auto& triangle : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    for (const std::uint32_t index : triangle) append(bytes, static_cast<std::int32_t>(index));
  }
  return bytes;
}

std::string ply_bytes(const PointCloud& cloud, double scale) {
  std::string bytes = header(cloud.size(), !cloud.normals.empty(), !cloud.colors.empty(), 0);
  append_vertices(bytes, cloud.points, cloud.normals, cloud.colors, scale);
  return bytes;
}

Status write_ply(const std::string& path, const TriangleMesh& mesh, double scale) {
  return write_file(path, ply_bytes(mesh, scale));
}

Status write_ply(const std::string& path, const PointCloud& cloud, double scale) {
  return write_file(path, ply_bytes(cloud, scale));
}

}  // namespace bpa::io
