// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/io/mesh_file.hpp"

// What mesh_file.cpp puts together.

namespace bpa::io {

/// A PLY file. The mesh has texture coordinates and texture_of if the file has, but no textures.
struct PlyFile {
  TriangleMesh mesh;
  std::vector<std::string> textures;  ///< Names of image files, in the order of their indices.
  std::string unread_color;           ///< A property of a mesh without colours that may hold some.
};

/// As parse_ply().
Result<PlyFile> parse_ply_file(std::string_view bytes, const std::string& name, double scale);

/// Reads any other format of read_mesh_file(), by Assimp; `colored` = false as read_mesh().
Result<MeshFile> read_with_assimp(const std::string& path, double scale, bool colored);

/// Takes the colours from a mesh; the warning says why.
void drop_colors(const std::string& reason, MeshFile& file);

}  // namespace bpa::io
