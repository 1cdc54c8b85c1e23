// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/mesh_assimp.hpp"

#include <algorithm>
#include <cmath>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace bpa::io {
namespace {

Eigen::Vector3f to_eigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
}

void append_mesh(const aiMesh& part, bool normals, bool colors, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    mesh.vertices.push_back(to_eigen(part.mVertices[i]));
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

}  // namespace

Result<TriangleMesh> read_mesh_with_assimp(const std::string& path) {
  try {
    Assimp::Importer importer;
    const aiScene* scene =
        importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                    aiProcess_PreTransformVertices);
    if (scene == nullptr) {
      return Status(StatusCode::corrupt, path + " cannot be read: " + importer.GetErrorString());
    }
    bool normals = true;
    bool colors = true;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
      normals = normals && scene->mMeshes[i]->HasNormals();
      colors = colors && scene->mMeshes[i]->HasVertexColors(0);
    }
    TriangleMesh mesh;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
      append_mesh(*scene->mMeshes[i], normals, colors, mesh);
    }
    return mesh;
  } catch (const std::exception& error) {
    return Status(StatusCode::corrupt, path + " cannot be read: " + error.what());
  }
}

}  // namespace bpa::io
