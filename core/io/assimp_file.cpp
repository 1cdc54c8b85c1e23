// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <sstream>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/base/concat.hpp"
#include "core/cloud/cielab.hpp"
#include "core/cloud/join_vertices.hpp"
#include "core/cloud/texture.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/private/mesh_parts.hpp"
#include "core/io/private/texture_files.hpp"

namespace bpa::io {
namespace {

Eigen::Vector3f to_eigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }
Eigen::Vector3f to_eigen(const aiColor4D& c) { return {c.r, c.g, c.b}; }

std::array<std::uint8_t, 3> to_rgb(const Eigen::Vector3f& color) {
  std::array<std::uint8_t, 3> rgb;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[c], 0.0f, 1.0f)));
  }
  return rgb;
}

/// glTF's factors and colours of vertices are light; the other formats write sRGB.
Eigen::Vector3f srgb(const Eigen::Vector3f& light) {
  return light.unaryExpr(
      [](float value) { return static_cast<float>(srgb_of_linear(static_cast<double>(value))); });
}

/// What a part of a mesh is coloured by: a texture, its vertices, or one colour.
struct PartColor {
  enum class Source { none, texture, vertices, material } source = Source::none;
  int texture = -1;  ///< Index in mesh.textures.
  unsigned channel = 0;
  Eigen::Vector2f scale{1, 1}, shift{0, 0};  ///< Of texture coordinates.
  Eigen::Vector3f factor{1, 1, 1};           ///< Of the material.
};

Wrap wrap_of(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Mirror) return Wrap::mirror;
  return mode == aiTextureMapMode_Wrap ? Wrap::repeat : Wrap::clamp;
}

/// Reads a scene of Assimp, one material a part.
class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::string& path)
      : scene_(scene), extension_(lower_extension(path)), textures_(path) {
    file_.metres = gltf() || extension_ == "dae";
  }

  MeshFile read(double scale, bool colored) {
    std::vector<PartColor> colors;
    std::string reason;
    const std::vector<const aiMesh*> parts = solid_parts();
    for (const aiMesh* part : parts) {
      Result<PartColor> color = colored ? color_of(*part) : vertex_color_of(*part);
      if (!color.ok() && reason.empty()) reason = color.status().message;
      colors.push_back(color.ok() ? *color : PartColor{});
    }
    const auto none = std::ranges::count(colors, PartColor::Source::none, &PartColor::source);
    const bool all = none == 0;
    if (!all && none < std::ssize(colors) && reason.empty() && colored) {
      reason = "has parts without colour beside others with colour";
    }
    const bool normals =
        std::ranges::all_of(parts, [](const aiMesh* part) { return part->HasNormals(); });
    for (std::size_t i = 0; i < parts.size(); ++i) {
      append(*parts[i], colors[i].channel, normals, scale);
      if (all) append_colors(*parts[i], colors[i]);
    }
    if (!reason.empty()) drop_colors(reason, file_);
    drop_unused();
    return std::move(file_);
  }

 private:
  bool gltf() const { return extension_ == "glb" || extension_ == "gltf"; }

  /// Those with triangles; all, if none has.
  std::vector<const aiMesh*> solid_parts() const {
    const std::vector<const aiMesh*> all(scene_.mMeshes, scene_.mMeshes + scene_.mNumMeshes);
    std::vector<const aiMesh*> solid;
    std::ranges::copy_if(all, std::back_inserter(solid), [](const aiMesh* part) {
      return (part->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0;
    });
    return solid.empty() ? all : solid;
  }

  Result<PartColor> vertex_color_of(const aiMesh& part) const {
    PartColor color;
    if (part.HasVertexColors(0)) color.source = PartColor::Source::vertices;
    return color;
  }

  /// Fails when the file promises a colour that cannot be had.
  Result<PartColor> color_of(const aiMesh& part) {
    const aiMaterial& material = *scene_.mMaterials[part.mMaterialIndex];
    PartColor color;
    // What Assimp says of a material without colour; white is glTF's own default.
    const Eigen::Vector3f unknown = Eigen::Vector3f::Constant(gltf() ? 1.0f : 0.6f);
    aiColor4D diffuse;
    const bool known = extension_ != "stl" &&
                       material.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) == aiReturn_SUCCESS &&
                       to_eigen(diffuse) != unknown;
    if (known) color.factor = to_eigen(diffuse);
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      if (material.GetTextureCount(type) > 0) return texture_of(part, material, type, color);
    }
    if (part.HasVertexColors(0)) {
      color.source = PartColor::Source::vertices;
    } else if (known) {
      color.source = PartColor::Source::material;
    } else if (part.HasTextureCoords(0)) {
      return corrupt("has texture coordinates, but names no texture (is its material file there?)");
    } else if (const std::string name = material.GetName().C_Str();
               extension_ != "stl" && !name.empty() && name != AI_DEFAULT_MATERIAL_NAME) {
      return corrupt("has the material ", name,
                     ", of which no colour is known (is its material file there?)");
    }
    return color;
  }

  Result<PartColor> texture_of(const aiMesh& part, const aiMaterial& material, aiTextureType type,
                               PartColor color) {
    aiString name;
    aiTextureMapMode modes[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    material.GetTexture(type, 0, &name, nullptr, &color.channel, nullptr, nullptr, modes);
    TextureReference reference;
    reference.name = name.C_Str();
    reference.wrap = {wrap_of(modes[0]), wrap_of(modes[1])};
    if (gltf()) reference.factor = color.factor;
    if (!part.HasTextureCoords(color.channel)) {
      return corrupt("has the texture ", reference.name, ", but no texture coordinates");
    }
    if (aiUVTransform place;
        material.Get(AI_MATKEY_UVTRANSFORM(type, 0), place) == aiReturn_SUCCESS) {
      if (place.mRotation != 0) return corrupt("turns its texture, which cannot be read");
      color.scale = {place.mScaling.x, place.mScaling.y};
      color.shift = {place.mTranslation.x, place.mTranslation.y};
    }
    if (const aiTexture* held = scene_.GetEmbeddedTexture(name.C_Str()); held != nullptr) {
      // Of an image file mWidth is the size in bytes; other pixels have a height.
      const std::size_t size = held->mHeight == 0 ? held->mWidth : 0;
      reference.bytes = {reinterpret_cast<const char*>(held->pcData), size};
    }
    const Result<int> index = textures_.add(reference, file_.mesh);
    if (!index.ok()) return index.status();
    color.source = PartColor::Source::texture;
    color.texture = *index;
    return color;
  }

  /// The vertices of a part that differ; texture coordinates are those of `channel`. Assimp does
  /// the same in 600 bytes a vertex.
  static JoinedVertices join(const aiMesh& part, unsigned channel) {
    return join_vertices(part.mNumVertices, [&](std::uint32_t i) {
      std::array<float, 12> numbers{};
      const auto put = [&](std::size_t at, const auto& value) {
        Eigen::Vector3f::Map(&numbers[at]) = to_eigen(value);
      };
      put(0, part.mVertices[i]);
      if (part.HasNormals()) put(3, part.mNormals[i]);
      if (part.HasTextureCoords(channel)) put(6, part.mTextureCoords[channel][i]);
      if (part.HasVertexColors(0)) put(9, part.mColors[0][i]);
      return numbers;
    });
  }

  void append(const aiMesh& part, unsigned channel, bool normals, double scale) {
    TriangleMesh& mesh = file_.mesh;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    joined_ = join(part, channel);
    for (const std::uint32_t i : joined_.kept) {
      const Eigen::Vector3f vertex = to_eigen(part.mVertices[i]);
      mesh.vertices.push_back((scale * vertex.cast<double>()).cast<float>());
      if (normals) mesh.normals.push_back(to_eigen(part.mNormals[i]).stableNormalized());
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      const auto corner = [&](unsigned k) { return first + joined_.place[face.mIndices[k]]; };
      mesh.triangles.push_back({corner(0), corner(1), corner(2)});
    }
  }

  /// Of the part that was appended last.
  void append_colors(const aiMesh& part, const PartColor& color) {
    TriangleMesh& mesh = file_.mesh;
    mesh.texture_of.resize(mesh.triangles.size(), color.texture);
    for (const std::uint32_t i : joined_.kept) {
      Eigen::Vector3f rgb = color.factor;
      if (color.source == PartColor::Source::vertices) {
        const Eigen::Vector3f own = to_eigen(part.mColors[0][i]);
        rgb = gltf() ? Eigen::Vector3f(own.cwiseProduct(color.factor)) : own;
      }
      mesh.colors.push_back(to_rgb(gltf() ? srgb(rgb) : rgb));
      Eigen::Vector2f& uv = mesh.uv.emplace_back(0, 0);
      if (color.texture < 0) continue;
      const Eigen::Vector3f given = to_eigen(part.mTextureCoords[color.channel][i]);
      uv = color.scale.cwiseProduct(given.head<2>()) + color.shift;
    }
  }

  void drop_unused() {
    TriangleMesh& mesh = file_.mesh;
    if (mesh.textures.empty()) {
      clear_textures(mesh);
    } else if (std::ranges::count(mesh.texture_of, -1) == 0) {
      mesh.colors.clear();
    }
  }

  const aiScene& scene_;
  std::string extension_;
  TextureFiles textures_;
  JoinedVertices joined_;  ///< Of the part that was appended last.
  MeshFile file_;
};

/// Leaves the importers that name the extension. Any other would take a file by its first bytes,
/// whatever its name: a .glb that begins with "ply" kept Assimp 5.2.5 busy for ever.
void keep_importers(const std::string& extension, Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::istringstream extensions(importer.GetImporterInfo(i)->mFileExtensions);
    const std::istream_iterator<std::string> first(extensions), last;
    if (std::find(first, last, extension) != last) continue;
    std::unique_ptr<Assimp::BaseImporter> other(importer.GetImporter(i));
    if (importer.UnregisterLoader(other.get()) != aiReturn_SUCCESS) (void)other.release();
  }
}

}  // namespace

Result<MeshFile> read_with_assimp(const std::string& path, double scale, bool colored) {
  if (!is_file(path)) return not_found(path, " cannot be opened");
  try {
    Assimp::Importer importer;
    keep_importers(lower_extension(path), importer);
    // COLLADA's up axis says how to stand the object up, not which axes it has.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    const aiScene* scene =
        importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices);
    if (!scene) return corrupt(path, " cannot be read: ", importer.GetErrorString());
    return SceneReader(*scene, path).read(scale, colored);
  } catch (const std::exception& error) {
    return corrupt(path, " cannot be read: ", error.what());
  }
}

}  // namespace bpa::io
