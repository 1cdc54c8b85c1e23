// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Each format with the same square and image; the colours at its four corners are known.
#include <gtest/gtest.h>

#include "core/cloud/texture.hpp"
#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::slurp;
using test::spill;

using Rgb = std::array<int, 3>;

constexpr Rgb kRed{255, 0, 0}, kGreen{0, 255, 0}, kBlue{0, 0, 255}, kYellow{255, 255, 0};

/// Red and green above blue and yellow.
ColorImage quadrants() {
  ColorImage image{16, 16, {}};
  for (int i = 0; i < 256; ++i) {
    const bool right = i % 16 >= 8, low = i / 16 >= 8;
    const Rgb& rgb = low ? (right ? kYellow : kBlue) : (right ? kGreen : kRed);
    for (const int value : rgb) image.pixels.push_back(static_cast<std::uint8_t>(value));
  }
  return image;
}

/// The colour of a mesh in the plane z = 0 at a point of it, within a square of 1 mm.
Rgb color_on(const TriangleMesh& mesh, float x, float y) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    Eigen::Matrix2f sides;
    sides << (mesh.vertices[b] - mesh.vertices[a]).head<2>(),
        (mesh.vertices[c] - mesh.vertices[a]).head<2>();
    const Eigen::Vector2f from_a = Eigen::Vector2f(x, y) - mesh.vertices[a].head<2>();
    const Eigen::Vector2f weights = sides.inverse() * from_a;
    if (weights.minCoeff() < 0 || weights.sum() > 1) continue;
    const Eigen::Vector3f color = color_at(mesh, t, weights, 0.001f);
    Rgb rgb;
    for (int k = 0; k < 3; ++k) rgb[static_cast<std::size_t>(k)] = static_cast<int>(color[k]);
    return rgb;
  }
  ADD_FAILURE() << "no triangle at " << x << ", " << y;
  return {};
}

void expect_quadrants(const TriangleMesh& mesh) {
  ASSERT_TRUE(has_colors(mesh));
  EXPECT_EQ(color_on(mesh, 0.021f, 0.083f), kRed);
  EXPECT_EQ(color_on(mesh, 0.079f, 0.083f), kGreen);
  EXPECT_EQ(color_on(mesh, 0.021f, 0.017f), kBlue);
  EXPECT_EQ(color_on(mesh, 0.079f, 0.017f), kYellow);
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

void append_bytes(std::string& bytes, const auto& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), sizeof values);
}

/// A glTF scene: the square; v is down. `image` and `material` are JSON.
struct Gltf {
  std::string image = R"({"uri": "image.png"})";
  std::string material = R"({"name": "paint", "pbrMetallicRoughness": {"baseColorTexture":
                             {"index": 0}}})";
  std::string held;  ///< Bytes of an image behind the others in the buffer.
  std::string attributes = R"("POSITION": 0, "TEXCOORD_0": 1)";

  std::string buffer() const {
    std::string bytes;
    append_bytes(bytes, std::array<float, 12>{0, 0, 0, 0.1f, 0, 0, 0.1f, 0.1f, 0, 0, 0.1f, 0});
    append_bytes(bytes, std::array<float, 8>{0, 1, 1, 1, 1, 0, 0, 0});
    append_bytes(bytes, std::array<std::uint16_t, 6>{0, 1, 2, 0, 2, 3});
    return bytes + held;
  }

  /// The buffer is part of the text, unless it is binary.
  std::string json(bool binary) const {
    const std::string bytes = buffer();
    const std::string uri =
        binary ? "" : R"(, "uri": "data:application/octet-stream;base64,)" + base64(bytes) + '"';
    const std::string view = held.empty() ? ""
                                          : R"(, {"buffer": 0, "byteOffset": 92,
        "byteLength": )" + std::to_string(held.size()) +
                                                "}";
    return R"({"asset": {"version": "2.0"},
      "extensionsUsed": ["KHR_texture_transform"], "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "materials": [)" +
           material + R"(],
      "meshes": [{"primitives": [{"attributes": {)" +
           attributes + R"(},
        "indices": 2, "material": 0}]}],
      "textures": [{"source": 0}], "images": [)" +
           image + R"(],
      "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
         "max": [0.1, 0.1, 0]},
        {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
        {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
        {"buffer": 0, "byteOffset": 48, "byteLength": 32},
        {"buffer": 0, "byteOffset": 80, "byteLength": 12})" +
           view + R"(],
      "buffers": [{"byteLength": )" +
           std::to_string(bytes.size()) + uri + "}]}";
  }

  std::string glb() const {
    std::string text = json(true), bytes = buffer();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    const auto size = static_cast<std::uint32_t>(28 + text.size() + bytes.size());
    std::string out = "glTF";
    append_bytes(out,
                 std::array<std::uint32_t, 3>{2, size, static_cast<std::uint32_t>(text.size())});
    out += "JSON" + text;
    append_bytes(out, std::array<std::uint32_t, 1>{static_cast<std::uint32_t>(bytes.size())});
    return out + std::string("BIN\0", 4) + bytes;
  }
};

/// COLLADA in centimetres, its z axis up; `diffuse` is XML.
std::string collada(const std::string& diffuse) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i"><init_from>image.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON>
<newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="c"><lambert><diffuse>)" +
         diffuse + R"(</diffuse></lambert></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 10 0 0 10 10 0 0 10 0</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="8">0 0 1 0 1 1 0 1</float_array>
<technique_common><accessor source="#ua" count="4" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="n" count="2"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/>
<p>0 0 1 1 2 2 0 0 2 2 3 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="n" target="#m">
<bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/></instance_material>
</technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)";
}

const char* const kColladaTexture = R"(<texture texture="t" texcoord="UV"/>)";

const char* const kObj =
    "mtllib a.mtl\nv 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// The square as BOP writes it, in ascii.
std::string ply(const std::string& comment) {
  return "ply\nformat ascii 1.0\n" + comment +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property float texture_u\nproperty float texture_v\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0 0 0\n0.1 0 0 1 0\n0.1 0.1 0 1 1\n0 0.1 0 0 1\n4 0 1 2 3\n";
}

class MeshTexture : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_color_png(folder_ / "image.png", quadrants()).ok()); }

  MeshFile read(const std::string& name, const std::string& bytes) {
    spill(folder_ / name, bytes);
    Result<MeshFile> file = read_mesh_file(folder_ / name);
    EXPECT_TRUE(file.ok()) << file.status().message;
    return file.ok() ? std::move(file).value() : MeshFile{};
  }

  void expect_textured(const std::string& name, const std::string& bytes) {
    SCOPED_TRACE(name);
    const MeshFile file = read(name, bytes);
    for (const std::string& warning : file.warnings) ADD_FAILURE() << warning;
    expect_quadrants(file.mesh);
  }

  /// Reads a mesh without colour and returns its one warning.
  std::string warning_of(const std::string& name, const std::string& bytes) {
    const MeshFile file = read(name, bytes);
    EXPECT_FALSE(has_colors(file.mesh));
    EXPECT_EQ(file.mesh.triangles.size(), 2u);
    EXPECT_EQ(file.warnings.size(), 1u);
    return file.warnings.empty() ? "" : file.warnings.front();
  }

  test::TemporaryFolder folder_;
};

TEST_F(MeshTexture, Obj) {
  // The space at the end is what the YCB scans have.
  spill(folder_ / "a.mtl", "newmtl m\nmap_Kd image.png \n");
  expect_textured("a.obj", kObj);
  spill(folder_ / "a.mtl", "newmtl m\nKd 0.2 0.2 0.2\nmap_Kd C:\\Users\\me\\image.png\n");
  expect_textured("b.obj", kObj);
}

TEST_F(MeshTexture, Gltf) {
  const std::string png = slurp(folder_ / "image.png");
  Gltf gltf;
  expect_textured("beside.gltf", gltf.json(false));
  gltf.image = R"({"uri": "data:image/png;base64,)" + base64(png) + "\"}";
  expect_textured("inside.gltf", gltf.json(false));
  spill(folder_ / "my image.png", png);
  gltf.image = R"({"uri": "my%20image.png"})";
  expect_textured("escaped.gltf", gltf.json(false));
  gltf.image = R"({"bufferView": 3, "mimeType": "image/png"})";
  gltf.held = png;
  expect_textured("a.glb", gltf.glb());
}

TEST_F(MeshTexture, Collada) {
  expect_textured("a.dae", collada(kColladaTexture));
  const MeshFile file = read("a.dae", collada(kColladaTexture));
  EXPECT_TRUE(file.metres);
  // Ten centimetres; the axes are those of the file.
  EXPECT_LT((file.mesh.vertices.at(2) - Eigen::Vector3f(0.1f, 0.1f, 0)).norm(), 1e-6f);
}

TEST_F(MeshTexture, Ply) {
  expect_textured("a.ply", ply("comment TextureFile image.png\r\n"));
  ASSERT_TRUE(write_color_png(folder_ / "other.png", {1, 1, {9, 9, 9}}).ok());
  // MeshLab's form: coordinates for each corner, so that vertices on a seam have several.
  expect_textured("b.ply",
                  "ply\nformat ascii 1.0\ncomment TextureFile other.png\ncomment TextureFile "
                  "other.png\ncomment TextureFile image.png\n"
                  "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face 2\nproperty list uchar int vertex_indices\n"
                  "property list uchar float texcoord\nproperty int texnumber\nend_header\n"
                  "0 0 0\n0.1 0 0\n0.1 0.1 0\n0 0.1 0\n"
                  "3 0 1 2 6 0 0 1 0 1 1 2\n3 0 2 3 6 2 0 3 1 2 1 2\n");
}

TEST_F(MeshTexture, GltfPlacesTheImage) {
  // KHR_texture_transform: the lower half of the image, v from 0.5 to 1, fills the square.
  Gltf gltf;
  gltf.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
      {"KHR_texture_transform": {"offset": [0, 0.5], "scale": [1, 0.5]}}}}})";
  const TriangleMesh mesh = read("a.gltf", gltf.json(false)).mesh;
  EXPECT_EQ(color_on(mesh, 0.021f, 0.083f), kBlue);
  EXPECT_EQ(color_on(mesh, 0.079f, 0.083f), kYellow);
}

TEST_F(MeshTexture, MaterialsWithoutTextureHaveOneColor) {
  spill(folder_ / "a.mtl", "newmtl m\nKd 1 0.5 0\n");
  const MeshFile obj = read("a.obj", kObj);
  EXPECT_EQ(color_on(obj.mesh, 0.02f, 0.05f), (Rgb{255, 128, 0}));
  const MeshFile dae = read("a.dae", collada("<color>1 0.5 0 1</color>"));
  EXPECT_EQ(color_on(dae.mesh, 0.02f, 0.05f), (Rgb{255, 128, 0}));
  // glTF writes light: half of it is 188 of 255 in sRGB.
  Gltf gltf;
  gltf.material = R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}})";
  EXPECT_EQ(color_on(read("a.gltf", gltf.json(false)).mesh, 0.02f, 0.05f), (Rgb{255, 188, 0}));
  // It multiplies a texture.
  gltf.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
                      "baseColorFactor": [0.5, 1, 1, 1]}})";
  EXPECT_EQ(color_on(read("b.gltf", gltf.json(false)).mesh, 0.021f, 0.083f), (Rgb{188, 0, 0}));
}

TEST_F(MeshTexture, OnePartWithoutColorTakesItFromAll) {
  spill(folder_ / "a.mtl", "newmtl m\nmap_Kd image.png\nnewmtl n\nKd 1 0 0\n");
  const std::string two = std::string(kObj) + "v 0 0 0.1\n";
  const MeshFile both = read("a.obj", two + "usemtl n\nf 1 2 5\n");
  EXPECT_TRUE(both.warnings.empty());
  expect_quadrants(both.mesh);
  EXPECT_EQ(color_at(both.mesh, 2, {0.3f, 0.3f}, 0.001f), Eigen::Vector3f(255, 0, 0));
  spill(folder_ / "a.mtl", "newmtl m\nmap_Kd image.png\nnewmtl n\n");
  const MeshFile one = read("a.obj", two + "usemtl n\nf 1 2 5\n");
  EXPECT_FALSE(has_colors(one.mesh));
  EXPECT_EQ(one.warnings,
            std::vector<std::string>{"has the material n, of which no colour is known (is its "
                                     "material file there?): the model has no colour"});
}

TEST_F(MeshTexture, WhatIsMissingIsSaidOnce) {
  const std::string gone =
      "texture gone.png is neither there nor beside the mesh: the model has "
      "no colour";
  EXPECT_EQ(warning_of("a.ply", ply("comment TextureFile gone.png\n")), gone);
  spill(folder_ / "a.mtl", "newmtl m\nmap_Kd gone.png\n");
  EXPECT_EQ(warning_of("a.obj", kObj), gone);
  Gltf gltf;
  gltf.image = R"({"uri": "gone.png"})";
  EXPECT_EQ(warning_of("a.gltf", gltf.json(false)), gone);

  EXPECT_EQ(warning_of("b.ply", ply("")),
            "has texture coordinates, but names no texture: the model has no colour");
  std::filesystem::remove(folder_ / "a.mtl");
  EXPECT_EQ(warning_of("b.obj", kObj),
            "has texture coordinates, but names no texture (is its material file there?): the "
            "model has no colour");
  gltf = {};
  gltf.attributes = R"("POSITION": 0)";
  EXPECT_EQ(warning_of("b.gltf", gltf.json(false)),
            "has the texture image.png, but no texture coordinates: the model has no colour");
  std::string nan = ply("comment TextureFile image.png\n");
  nan.replace(nan.find("0.1 0 0 1 0"), 11, "0.1 0 0 nan 0");
  EXPECT_EQ(warning_of("c.ply", nan),
            "has texture coordinates that are not finite: the model has no colour");
}

TEST_F(MeshTexture, PlyFallsBackToItsVertices) {
  const MeshFile file = read(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile gone.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty float texture_u\nproperty float texture_v\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 9 8 7 0 0\n0.1 0 0 9 8 7 1 0\n0.1 0.1 0 9 8 7 1 1\n3 0 1 2\n");
  EXPECT_EQ(color_on(file.mesh, 0.08f, 0.02f), (Rgb{9, 8, 7}));
  EXPECT_EQ(file.warnings,
            std::vector<std::string>{"texture gone.png is neither there nor beside the mesh: the "
                                     "colours of the vertices are used"});
}

TEST_F(MeshTexture, APlainMeshSaysNothing) {
  const MeshFile file = read("a.obj", "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nf 1 2 3\n");
  EXPECT_FALSE(has_colors(file.mesh));
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_FALSE(file.metres);
}

TEST_F(MeshTexture, BadImagesAreSaid) {
  const std::string mesh = ply("comment TextureFile bad.png\n");
  const std::string end = ": the model has no colour";
  spill(folder_ / "bad.png", "GIF89a");
  EXPECT_EQ(warning_of("a.ply", mesh), "texture bad.png is not a PNG or JPEG image" + end);
  const std::string png = slurp(folder_ / "image.png");
  spill(folder_ / "bad.png", png.substr(0, png.size() - 20));
  EXPECT_EQ(warning_of("a.ply", mesh), "texture bad.png is truncated" + end);
  // A few bytes that say they are 65535 x 65535 pixels.
  std::string bomb = png;
  bomb.replace(16, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
  spill(folder_ / "bad.png", bomb);
  EXPECT_EQ(warning_of("a.ply", mesh),
            "texture bad.png has 65535x65535 pixels; each side must be 1 to 8192" + end);
}

TEST_F(MeshTexture, TruncatedFilesAreNoCrash) {
  Gltf gltf;
  gltf.image = R"({"bufferView": 3, "mimeType": "image/png"})";
  gltf.held = slurp(folder_ / "image.png");
  spill(folder_ / "a.mtl", "newmtl m\nmap_Kd image.png\n");
  const std::pair<const char*, std::string> files[] = {{"cut.glb", gltf.glb()},
                                                       {"cut.gltf", gltf.json(false)},
                                                       {"cut.dae", collada(kColladaTexture)},
                                                       {"cut.obj", kObj}};
  for (const auto& [name, bytes] : files) {
    for (std::size_t size = 0; size < bytes.size(); size += 13) {
      spill(folder_ / name, bytes.substr(0, size));
      const Result<MeshFile> file = read_mesh_file(folder_ / name);
      if (!file.ok()) {
        EXPECT_EQ(file.status().code, StatusCode::corrupt);
      }
    }
  }
}

TEST_F(MeshTexture, PlySurvivesWriting) {
  const MeshFile one = read("a.ply", ply("comment TextureFile image.png\n"));
  ASSERT_TRUE(write_ply(folder_ / "out/mm.ply", one.mesh, 1000).ok());
  EXPECT_NE(slurp(folder_ / "out/mm.ply").find("comment TextureFile mm.png\n"), std::string::npos);
  const Result<MeshFile> back = read_mesh_file(folder_ / "out/mm.ply", 0.001);
  ASSERT_TRUE(back.ok()) << back.status().message;
  expect_quadrants(back->mesh);

  // Two textures and a part without.
  TriangleMesh mesh = one.mesh;
  mesh.textures.push_back(make_texture(RgbImage(1, 1, {9, 8, 7})));
  mesh.colors.assign(4, {1, 2, 3});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {0, 1, 2}});
  mesh.texture_of.insert(mesh.texture_of.end(), {1, -1});
  ASSERT_TRUE(write_ply(folder_ / "out/two.ply", mesh).ok());
  const Result<MeshFile> two = read_mesh_file(folder_ / "out/two.ply");
  ASSERT_TRUE(two.ok()) << two.status().message;
  expect_quadrants(two->mesh);
  EXPECT_EQ(color_at(two->mesh, 2, {0.2f, 0.2f}, 0.001f), Eigen::Vector3f(9, 8, 7));
  EXPECT_EQ(color_at(two->mesh, 3, {0.2f, 0.2f}, 0.001f), Eigen::Vector3f(1, 2, 3));
}

TEST_F(MeshTexture, ReadMeshReadsNoImage) {
  spill(folder_ / "a.ply", ply("comment TextureFile gone.png\n"));
  const Result<TriangleMesh> mesh = read_mesh(folder_ / "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_TRUE(mesh->uv.empty());
  EXPECT_FALSE(has_colors(*mesh));
}

}  // namespace
}  // namespace bpa::io
