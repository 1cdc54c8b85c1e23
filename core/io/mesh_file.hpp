// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/point_cloud.hpp"

namespace bpa::io {

/// A mesh with its textures.
struct MeshFile {
  TriangleMesh mesh;
  std::vector<std::string> warnings;  ///< Why the mesh has no colour though the file has some.
  bool metres = false;                ///< The format fixes metres: glTF and COLLADA.
};

/// Extensions, lower-case and without dot, of the files that read_mesh reads.
const std::vector<std::string>& mesh_extensions();

/// Reads a triangle mesh: PLY, OBJ, STL, glTF (also GLB) or COLLADA, by its extension. Coordinates
/// are multiplied by `scale`: 0.001 for files in millimetres. COLLADA's unit is applied before, its
/// up axis is not. Polygons are cut into triangles; a mesh without triangles has only vertices.
/// Normals as far as the file has them. A triangle has the colour of its texture (PNG or JPEG,
/// beside the file or in it), else of its vertices, else of its material. If one triangle lacks a
/// colour, the mesh has none; the warnings say why if the file has some. Fails with not_found,
/// corrupt (truncated, damaged) or unsupported (another extension); the message names the file.
Result<MeshFile> read_mesh_file(const std::string& path, double scale = 1.0);

/// The same without textures and colours of materials; reads no image.
Result<TriangleMesh> read_mesh(const std::string& path, double scale = 1.0);

/// Reads the finite points of a PLY file (its faces are ignored) or a PCD file.
Result<PointCloud> read_point_cloud(const std::string& path, double scale = 1.0);

/// Writes binary little-endian PLY, coordinates multiplied by `scale`: 1000 for millimetres. The
/// textures of a mesh are written beside it as PNG: NAME.png for NAME.ply, then NAME_1.png.
Status write_ply(const std::string& path, const TriangleMesh& mesh, double scale = 1.0);
Status write_ply(const std::string& path, const PointCloud& cloud, double scale = 1.0);

/// The bytes that write_ply writes of a mesh without textures.
std::string ply_bytes(const TriangleMesh& mesh, double scale = 1.0);
std::string ply_bytes(const PointCloud& cloud, double scale = 1.0);

/// Reads PLY (ascii, binary of either byte order) from memory, without textures; `name` is for
/// messages.
Result<TriangleMesh> parse_ply(std::string_view bytes, const std::string& name, double scale = 1.0);

}  // namespace bpa::io
