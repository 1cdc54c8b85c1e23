// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/cloud/point_cloud.hpp"

namespace bpa::io {

/// Reads a triangle mesh (PLY, OBJ or STL by its extension). Coordinates are multiplied by `scale`:
/// 0.001 for files in millimetres. Polygons are cut into triangles; a mesh without triangles has
/// only vertices. Normals and colours as far as the file has them. Fails with not_found, corrupt
/// (truncated, damaged) or unsupported (another extension); the message names the file.
Result<TriangleMesh> read_mesh(const std::string& path, double scale = 1.0);

/// Reads the finite points of a PLY file (its faces are ignored) or a PCD file.
Result<PointCloud> read_point_cloud(const std::string& path, double scale = 1.0);

/// Writes binary little-endian PLY, coordinates multiplied by `scale`: 1000 for millimetres.
Status write_ply(const std::string& path, const TriangleMesh& mesh, double scale = 1.0);
Status write_ply(const std::string& path, const PointCloud& cloud, double scale = 1.0);

/// The bytes that write_ply writes.
std::string ply_bytes(const TriangleMesh& mesh, double scale = 1.0);
std::string ply_bytes(const PointCloud& cloud, double scale = 1.0);

/// Reads PLY (ascii, binary of either byte order) from memory; `name` is for messages.
Result<TriangleMesh> parse_ply(const std::string& bytes, const std::string& name,
                               double scale = 1.0);

}  // namespace bpa::io
