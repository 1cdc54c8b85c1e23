// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/status.hpp"
#include "core/cloud/texture.hpp"

namespace bpa::io {

/// A texture as a mesh's file speaks of it.
struct TextureReference {
  std::string name;                 ///< Of the image file, or of the image in the mesh's file.
  std::string_view bytes;           ///< Of the image, if the mesh's file holds it.
  std::array<Wrap, 2> wrap{};       ///< Along u and v.
  Eigen::Vector3f factor{1, 1, 1};  ///< Multiplies the light of the image.
};

/// Reads the textures of one mesh, each once.
class TextureFiles {
 public:
  explicit TextureFiles(std::string mesh_path) : mesh_path_(std::move(mesh_path)) {}

  /// The index of a texture in mesh.textures, where it is added if it is new. Looks for the file
  /// where its name says, then beside the mesh. Fails when it is not there, cannot be decoded, or
  /// all images together have more than 8192 x 8192 pixels.
  Result<int> add(const TextureReference& reference, TriangleMesh& mesh);

 private:
  Result<std::string> read(const std::string& name) const;

  std::string mesh_path_;
  std::map<std::string, int> indices_;
  std::size_t pixels_left_ = std::size_t{8192} * 8192;
};

}  // namespace bpa::io
