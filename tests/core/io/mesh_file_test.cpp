// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/mesh_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::spill;

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.2f, 0}, {0, 0, 0.3f}};
  mesh.colors = {{{1, 2, 3}}, {{4, 5, 6}}, {{7, 8, 9}}, {{250, 251, 252}}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    EXPECT_LT((a.vertices[i] - b.vertices[i]).norm(), 1e-6f);
  }
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(MeshFile, PlySurvivesWritingAndReadingInMillimetres) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_ply(folder / "a.ply", tetrahedron(), 1000).ok());
  const Result<TriangleMesh> back = read_mesh(folder / "a.ply", 0.001);
  ASSERT_TRUE(back.ok()) << back.status().message;
  expect_same(*back, tetrahedron());
}

TEST(MeshFile, AsciiPlyWithPolygonsAndExtraProperties) {
  const test::TemporaryFolder folder;
  spill(folder / "a.ply",
        "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nelement vertex 4\r\nproperty double x\r\n"
        "property double y\r\nproperty double z\r\nproperty float quality\r\n"
        "element face 1\r\nproperty uchar flags\r\nproperty list uchar int vertex_index\r\n"
        "end_header\r\n0 0 0 7\r\n1e0 0 0 7\r\n1 +1 0 7\r\n0 1 -.5 7\r\n9 4 0 1 2 3\r\n");
  const Result<TriangleMesh> mesh = read_mesh(folder / "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  ASSERT_EQ(mesh->vertices.size(), 4u);
  EXPECT_EQ(mesh->vertices[3], Eigen::Vector3f(0, 1, -0.5f));
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(MeshFile, BigEndianPly) {
  const test::TemporaryFolder folder;
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty short y\n"
      "property uchar z\nend_header\n";
  bytes += std::string("\x3f\xc0\x00\x00\xff\xfe\x05", 7);  // 1.5, -2, 5
  spill(folder / "a.ply", bytes);
  const Result<TriangleMesh> mesh = read_mesh(folder / "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_EQ(mesh->vertices.at(0), Eigen::Vector3f(1.5f, -2, 5));
}

TEST(MeshFile, EveryTruncationOfPlyIsCorrupt) {
  const std::string bytes = ply_bytes(tetrahedron());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<TriangleMesh> mesh = parse_ply(bytes.substr(0, size), "cut.ply");
    ASSERT_FALSE(mesh.ok()) << size;
    EXPECT_EQ(mesh.status().code, StatusCode::corrupt);
  }
}

TEST(MeshFile, AHugeCountIsRefusedBeforeMemoryIsTaken) {
  const std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n"
      "end_header\nabcd";
  EXPECT_EQ(parse_ply(bytes, "a.ply").status().code, StatusCode::corrupt);
}

TEST(MeshFile, ElementsWithoutPropertiesAreRefused) {
  const std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 400000\nend_header\n" +
      std::string(400'000, 'x');
  EXPECT_EQ(parse_ply(bytes, "a.ply").status().message,
            "a.ply has PLY element vertex without a property");
}

TEST(MeshFile, AnElementStandsOnce) {
  const std::string vertex = "property float x\nproperty float y\nproperty float z\n";
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 1\n" + vertex + "element vertex 1\n" + vertex +
      "property float nx\nproperty float ny\nproperty float nz\nend_header\n0 0 0\n0 0 0 0 0 1\n";
  const Status status = parse_ply(bytes, "a.ply").status();
  EXPECT_EQ(status.code, StatusCode::corrupt);
  EXPECT_NE(status.message.find("vertex twice"), std::string::npos) << status.message;
}

TEST(MeshFile, ColoursThatAreNoNumberAreBlack) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty float red\nproperty float green\nproperty float blue\n"
      "end_header\n0 0 0 nan 1e30 -1e30\n";
  const Result<TriangleMesh> mesh = parse_ply(bytes, "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_EQ(mesh->colors.at(0), (std::array<std::uint8_t, 3>{0, 255, 0}));
}

/// A triangle pair of four corners, as text.
std::string ply_text(const std::string& of_vertex, const std::string& of_face,
                     const std::string& faces, int face_count = 2) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\n" +
         of_vertex + "element face " + std::to_string(face_count) + "\n" + of_face +
         "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces;
}

constexpr const char* kIndices = "property list uchar int vertex_indices\n";

TEST(PlyFile, ColoursOfFacesAreThoseOfTheirCorners) {
  const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const auto mesh = parse_ply(ply_text("", kIndices + rgb, "3 0 1 2 9 8 7\n3 0 2 3 1 2 3\n"), "p");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  ASSERT_EQ(mesh->triangles.size(), 2u);
  ASSERT_EQ(mesh->colors.size(), mesh->vertices.size());
  for (std::size_t t = 0; t < 2; ++t) {
    const std::array<std::uint8_t, 3> color =
        t == 0 ? std::array<std::uint8_t, 3>{9, 8, 7} : std::array<std::uint8_t, 3>{1, 2, 3};
    for (const auto corner : mesh->triangles[t]) EXPECT_EQ(mesh->colors[corner], color);
  }
  EXPECT_EQ(mesh->vertices[mesh->triangles[1][2]], Eigen::Vector3f(0, 1, 0));
}

TEST(PlyFile, StripsAreTrianglesOfOneSide) {
  const auto mesh = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n10 0 1 2 3 4 5 -1 0 1 2\n",
      "p");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  ASSERT_EQ(mesh->triangles.size(), 5u);
  for (const auto& [a, b, c] : mesh->triangles) {
    const auto& v = mesh->vertices;
    EXPECT_EQ((v[b] - v[a]).cross(v[c] - v[a]).z(), 1);  // all up, all of area 1/2
  }
}

TEST(PlyFile, RowsAndBytesThatDoNotFitTheHeaderAreRefused) {
  const auto refusal = [](const std::string& bytes) {
    return parse_ply(bytes, "p.ply").status().message;
  };
  const std::string good = "3 0 1 2\n3 0 2 3\n";
  EXPECT_EQ(refusal(ply_text("", kIndices, good + "\n \n")), "");
  EXPECT_EQ(refusal(ply_text("", kIndices, "3 0 1 2\n3 0 2 3 6 0 0 1 0 1 1\n")),
            "p.ply has more numbers in row 2 of PLY element face than its header says; write it as "
            "binary PLY");
  EXPECT_EQ(refusal(ply_text("", kIndices, good + "3 0 1 3\n")),
            "p.ply has more bytes than its PLY header says");
  EXPECT_EQ(refusal(ply_text("property float nx\n", kIndices, good)).substr(0, 52),
            "p.ply has more numbers in row 1 of PLY element verte");
  EXPECT_NE(refusal(ply_text("", kIndices, "3 0 1,5 2\n3 0 2 3\n")).find("damaged"),
            std::string::npos);
  EXPECT_NE(refusal(ply_text("", "property list uchar int corners\n", good)).find("vertex_index"),
            std::string::npos);
  EXPECT_NE(refusal(ply_text("property float f_dc_0\nproperty float rot_0\n", kIndices, good))
                .find("Gaussian splat"),
            std::string::npos);
}

TEST(PlyFile, ReadsAnyLineEnds) {
  const std::string text = ply_text("", kIndices, "3 0 1 2\n3 0 2 3\n");
  for (const std::string end : {"\r", "\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? end : std::string(1, c);
    const auto mesh = parse_ply(other, "p");
    ASSERT_TRUE(mesh.ok()) << mesh.status().message;
    EXPECT_EQ(mesh->triangles, parse_ply(text, "p")->triangles);
  }
}

TEST(MeshFile, OtherFormatsAreRefusedWithTheWayOut) {
  const test::TemporaryFolder folder;
  spill(folder / "a.urdf",
        R"(<robot><mesh filename="package://x/cup.dae" scale="1 1 1"/></robot>)");
  spill(folder / "b.urdf", "<robot><mesh scale='1 1 1' filename='cup.stl'/></robot>");
  spill(folder / "a.sdf",
        "<sdf><include><uri>model://sun</uri></include>"
        "<mesh><uri>model://cup/cup.obj</uri></mesh></sdf>");
  spill(folder / "b.sdf", "<sdf><include><uri>model://sun</uri></include></sdf>");
  for (const auto& [name, words] : {std::pair("a.STEP", "freecadcmd"),
                                    {"a.3mf", "assimp export"},
                                    {"a.fbx", "assimp export"},
                                    {"a.usdz", "Blender"},
                                    {"a.off", "assimp export"},
                                    {"a.wrl", "MeshLab"},
                                    {"a.sldprt", "the CAD program"},
                                    {"b.urdf", "names: cup.stl"},
                                    {"b.sdf", "the mesh that it names"},
                                    {"a.urdf", "names: package://x/cup.dae"},
                                    {"a.sdf", "names: model://cup/cup.obj"},
                                    {"a.txt", "use .ply"}}) {
    const Status status = read_mesh(folder / name).status();
    EXPECT_EQ(status.code, StatusCode::unsupported);
    EXPECT_NE(status.message.find(words), std::string::npos) << status.message;
  }
}

TEST(MeshFile, ContentsThatDoNotFitTheNameAreNamed) {
  const test::TemporaryFolder folder;
  for (const auto& [name, content, words] :
       {std::tuple("a.stl", "ISO-10303-21;\nHEADER;", "a STEP file; mesh it: freecadcmd"),
        {"a.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:1", "git lfs pull"},
        {"a.glb", "PK\3\4\24", "a zip archive"},
        {"a.dae", "\x1f\x8b\x08", "gunzip"},
        {"a.ply", "\n <!DOCTYPE html>\n<html>", "a web page: its download failed"},
        {"b.stl", "ply\nformat ascii 1.0\n", "a PLY file"}}) {
    spill(folder / name, content);
    const Status status = read_mesh(folder / name).status();
    EXPECT_NE(status.message.find(words), std::string::npos) << status.message;
    EXPECT_EQ(status.message.find('\n'), std::string::npos);
  }
}

/// Each names a colour in another way; what is not read is said.
TEST(PlyFile, ColoursOfOtherNamesAreReadOrSaid) {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& properties, const std::string& values) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\n" +
        properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* point : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) text += point + values + "\n";
    spill(folder / "a.ply", text + "3 0 1 2\n");
    const Result<MeshFile> file = read_mesh_file(folder / "a.ply");
    EXPECT_TRUE(file.ok()) << file.status().message;
    return file.ok() ? *file : MeshFile{};
  };
  const std::array<std::uint8_t, 3> color{200, 100, 50};
  const auto three = [](const std::string& r, const std::string& g, const std::string& b) {
    return "property uchar " + r + "\nproperty uchar " + g + "\nproperty uchar " + b + "\n";
  };
  for (const MeshFile& file :
       {read(three("diffuse_red", "diffuse_green", "diffuse_blue"), "200 100 50"),
        read(three("r", "g", "b"), "200 100 50"), read("property uint rgba\n", "4291322930"),
        read("property int rgb\n", "13132850")}) {
    ASSERT_EQ(file.mesh.colors.size(), 3U);
    EXPECT_EQ(file.mesh.colors[0], color);
    EXPECT_TRUE(file.warnings.empty());
  }
  for (const char* property : {"float rgb", "uchar specular_red", "int material_index"}) {
    const MeshFile file = read("property " + std::string(property) + "\n", "1");
    EXPECT_TRUE(file.mesh.colors.empty());
    ASSERT_EQ(file.warnings.size(), 1U) << property;
    EXPECT_NE(file.warnings[0].find("which is not read: the model has no colour"),
              std::string::npos);
  }
}

TEST(MeshFile, CopiesOfATriangleAreOne) {
  const test::TemporaryFolder folder;
  std::string faces;
  for (int k = 0; k < 100; ++k) faces += "3 0 1 2\n3 2 0 1\n3 2 3 0\n";
  spill(folder / "a.ply", ply_text("", kIndices, faces + "3 2 1 0\n", 301));
  const Result<TriangleMesh> mesh = read_mesh(folder / "a.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_EQ(mesh->triangles.size(), 3u);  // one of them faces the other way
}

/// Many exporters write them; the format allows it.
TEST(MeshFile, NormalsOfZeroAreNone) {
  const test::TemporaryFolder folder;
  std::string stl = "solid x\n";
  for (const char* last : {"0 0 1", "0 1 0"}) {
    stl += std::string("facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ") +
           last + "\nendloop\nendfacet\n";
  }
  spill(folder / "a.stl", stl + "endsolid x\n");
  const Result<TriangleMesh> mesh = read_mesh(folder / "a.stl");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_EQ(mesh->triangles.size(), 2u);
  EXPECT_TRUE(mesh->normals.empty());
}

TEST(MeshFile, ObjAndStl) {
  const test::TemporaryFolder folder;
  spill(folder / "a.obj", "v 0 0 0\nv 10 0 0\nv 0 20 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\n");
  const Result<TriangleMesh> obj = read_mesh(folder / "a.obj", 0.001);
  ASSERT_TRUE(obj.ok()) << obj.status().message;
  EXPECT_EQ(obj->triangles.size(), 2u);
  EXPECT_EQ(obj->vertices.size(), 4u);
  spill(folder / "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid a\n");
  const Result<TriangleMesh> stl = read_mesh(folder / "a.stl");
  ASSERT_TRUE(stl.ok()) << stl.status().message;
  EXPECT_EQ(stl->triangles.size(), 1u);
  spill(folder / "bad.obj", "nothing of use");
  EXPECT_FALSE(read_mesh(folder / "bad.obj").ok());
  EXPECT_EQ(read_mesh(folder / "none.stl").status().code, StatusCode::not_found);
  EXPECT_EQ(read_mesh(folder / "a.fbx").status().code, StatusCode::unsupported);
}

}  // namespace
}  // namespace bpa::io
