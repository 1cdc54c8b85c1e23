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
