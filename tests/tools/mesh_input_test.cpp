// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mesh_input.hpp"

#include <gtest/gtest.h>

#include "tests/support/meshes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::cli {
namespace {

TEST(MeshInput, UnitsAreGuessedFromTheSize) {
  EXPECT_EQ(guess_unit(0.02), 1);
  EXPECT_EQ(guess_unit(1.5), 1);
  EXPECT_EQ(guess_unit(3), 1);
  EXPECT_EQ(guess_unit(3.1), 0.01);
  EXPECT_EQ(guess_unit(19.9), 0.01);
  EXPECT_EQ(guess_unit(20), 0.001);
  EXPECT_EQ(guess_unit(213), 0.001);
}

TEST(MeshInput, AFolderHasOneUnit) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> paths{folder / "box.ply", folder / "screw.ply"};
  ASSERT_TRUE(io::write_ply(paths[0], test::box_mesh({0.1f, 0.05f, 0.03f}), 1000).ok());
  ASSERT_TRUE(io::write_ply(paths[1], test::box_mesh({0.006f, 0.004f, 0.004f}), 1000).ok());
  double scale = 0;
  ::testing::internal::CaptureStdout();
  const std::vector<io::MeshFile> files = read_meshes(paths, scale);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(),
            "box.ply: assuming millimetres: 200 x 100 x 60 mm, like a shoe; --unit or --scale says "
            "otherwise\n"
            "screw.ply: assuming millimetres: 12 x 8 x 8 mm, like a coin; --unit or --scale says "
            "otherwise\n");
  EXPECT_EQ(scale, 0.001);
  EXPECT_NEAR(files[1].mesh.vertices[0].cwiseAbs().x(), 0.006f, 1e-6f);
}

/// Such as a part of two inches, which is no object of two metres.
TEST(MeshInput, SizesThatObjectsSeldomHaveNeedAUnit) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](float side) -> std::string {
    or_throw(io::write_ply(folder / "a.ply", test::box_mesh(Eigen::Vector3f::Constant(side / 2))));
    double scale = 0;
    try {
      ::testing::internal::CaptureStdout();
      (void)read_meshes({folder / "a.ply"}, scale);
    } catch (const Failure& failure) {
      ::testing::internal::GetCapturedStdout();
      return failure.what();
    }
    EXPECT_NE(::testing::internal::GetCapturedStdout(), "");
    return "";
  };
  EXPECT_NE(refusal(2).find("its longest side is 2; give one of --unit m (2000 mm), --unit cm (20 "
                            "mm), --unit mm (2 mm), --unit in (51 mm)"),
            std::string::npos)
      << refusal(2);
  for (const float side : {0.005f, 1.0f, 2.9f, 900.0f}) EXPECT_NE(refusal(side), "") << side;
  for (const float side : {0.02f, 0.7f, 4.0f, 30.0f, 700.0f}) EXPECT_EQ(refusal(side), "") << side;
}

TEST(MeshInput, PointsOfAFormatWithoutUnitAreInMetres) {
  ::testing::internal::CaptureStdout();
  assume_metres("a.pcd", {{0, 0, 0}, {0.1f, 0.05f, 0.02f}});
  EXPECT_EQ(
      ::testing::internal::GetCapturedStdout(),
      "a.pcd: assuming metres: 100 x 50 x 20 mm, like a mug; --unit or --scale says otherwise\n");
  EXPECT_THROW(assume_metres("a.pcd", {{0, 0, 0}, {2, 0, 0}}), Failure);
}

TEST(MeshInput, WhatTheUserSaysIsNotGuessed) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(io::write_ply(folder / "a.ply", test::box_mesh({5, 5, 5})).ok());
  double scale = 0.0254;
  ::testing::internal::CaptureStdout();
  const std::vector<io::MeshFile> files = read_meshes({folder / "a.ply"}, scale);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_NEAR(files[0].mesh.vertices[0].cwiseAbs().x(), 0.127f, 1e-6f);
}

TEST(MeshInput, UnitsHaveNames) {
  for (const auto& [name, metres] :
       {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}}) {
    CLI::App program;
    double scale = 0;
    add_unit_options(program, scale);
    program.parse(std::string("--unit ") + name);
    EXPECT_EQ(scale, metres);
    EXPECT_THROW(program.parse("--unit mm --scale 0.5"), CLI::ParseError);
    EXPECT_THROW(program.parse("--unit ft"), CLI::ParseError);
  }
}

}  // namespace
}  // namespace bpa::cli
