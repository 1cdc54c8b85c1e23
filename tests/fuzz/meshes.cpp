// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// PLY files by this project's own parser; textures; the other formats by Assimp.
#include "core/cloud/texture.hpp"
#include "core/io/mesh_file.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

void check(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) require(index < n, "a triangle has its corners");
  }
  require(mesh.normals.empty() || mesh.normals.size() == n, "each vertex has a normal or none");
  require(mesh.colors.empty() || mesh.colors.size() == n, "each vertex has a colour or none");
  require(mesh.uv.empty() || mesh.uv.size() == n, "each vertex has a place in a texture or none");
  require(mesh.texture_of.empty() || mesh.texture_of.size() == mesh.triangles.size(),
          "each triangle has a texture or none");
  for (const int texture : mesh.texture_of) {
    require(texture < static_cast<int>(mesh.textures.size()), "a triangle's texture is there");
  }
}

void run_ply(std::string_view bytes) {
  const auto mesh = io::parse_ply(bytes, "mesh.ply", 0.001);
  if (mesh.ok()) check(*mesh);
}

std::string ply(const std::string& format, const std::string& header, const std::string& values) {
  return "ply\nformat " + format + " 1.0\n" + header + "end_header\n" + values;
}

constexpr const char* kVertices =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

std::vector<std::string> ply_seeds() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  mesh.triangles = {{0, 1, 2}};
  const std::string big_endian_face("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13);
  const std::string textured = std::string(kVertices) +
                               "property float s\nproperty float t\ncomment TextureFile a.png\n"
                               "element face 1\nproperty list uchar int vertex_index\n"
                               "property list uchar float texcoord\nproperty int texnumber\n";
  return {io::ply_bytes(mesh),
          ply("ascii", std::string(kVertices) + "property double nx\n" + kFaces,
              "0 0 0 1\n1 0 0 1\n0 +1 1e-3 1\n3 0 1 2\n"),
          ply("binary_big_endian", std::string(kVertices) + kFaces,
              std::string(36, '\0') + big_endian_face),
          ply("ascii", textured, "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 6 0 0 1 0 0 1 0\n")};
}

/// A first line with the file's extension, then the file. Beside it lies an image.
void run_mesh(std::string_view bytes) {
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos) return;
  const std::string_view extension = bytes.substr(0, line);
  for (const std::string& known : io::mesh_extensions()) {
    if (extension != known) continue;
    const auto file = io::read_mesh_file(file_of(bytes.substr(line + 1), "mesh." + known));
    if (!file.ok()) return;
    check(file->mesh);
    for (const auto& vertex : file->mesh.vertices) {
      require(file->mesh.triangles.empty() || vertex.allFinite(), "each vertex is finite");
    }
  }
}

/// A triangle with a texture, whose image is in the file.
constexpr const char* kTexturedGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],")"
    R"(meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"mat)"
    R"(erial":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC)"
    R"(3","min":[0,0,0],"max":[1,1,0]},{"bufferView":1,"componentType":5126,"count":3,"type)"
    R"(":"VEC2"},{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],"bufferVi)"
    R"(ews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteL)"
    R"(ength":24},{"buffer":0,"byteOffset":60,"byteLength":6}],"buffers":[{"byteLength":68,)"
    R"("uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAA)"
    R"(gD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAABAAIAAAA="}],"materials":[{"pbrMetallicRo)"
    R"(ughness":{"baseColorTexture":{"index":0},"baseColorFactor":[1,0.5,1,1]}}],"textures")"
    R"(:[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071,"wrapT":33648}],"images":[{"u)"
    R"(ri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4n)"
    R"(GP438AAAAQBAYDFKhhdAAAAAElFTkSuQmCC"}]})";

/// A triangle with colours of its vertices.
constexpr const char* kColoredGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],")"
    R"(meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"indices":2,"materi)"
    R"(al":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
    R"("min":[0,0,0],"max":[1,1,0]},{"bufferView":1,"componentType":5126,"count":3,"type":")"
    R"(VEC3"},{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews)"
    R"(":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLeng)"
    R"(th":36},{"buffer":0,"byteOffset":72,"byteLength":6}],"buffers":[{"byteLength":80,"ur)"
    R"(i":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8)"
    R"(AAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAABAAIAAAA="}],"materials":[{})"
    R"(]})";

std::vector<std::string> mesh_seeds() {
  file_of("", "image.png");
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  const std::string binary_facet(50, '\0');
  return {"obj\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n",
          "obj\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n",
          std::string("gltf\n") + kTexturedGltf,
          std::string("gltf\n") + kColoredGltf,
          "stl\nsolid a\n" + facet + "endsolid a\n",
          "stl\n" + std::string(80, ' ') + std::string("\1\0\0\0", 4) + binary_facet,
          "ply\n" + ply_seeds().back()};
}

}  // namespace

std::vector<Target> mesh_targets() {
  return {{"ply", "core/io/ply_file.cpp", run_ply, ply_seeds, 8192, 4},
          {"mesh", "core/io/mesh_file.cpp core/io/assimp_file.cpp core/io/texture_files.cpp",
           run_mesh, mesh_seeds, 8192}};
}

}  // namespace bpa::fuzz
