// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/io/mesh_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

/// Mean difference of the colours of nearest points of two models, and of their grey values.
struct ColorDifference {
  double mean = 0, brightness = 0;
};

ColorDifference compare(const PointCloud& a, const PointCloud& b) {
  ColorDifference out;
  for (std::size_t i = 0; i < a.size(); i += 10) {
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < b.size(); ++j) {
      const float before = (b.points[nearest] - a.points[i]).squaredNorm();
      if ((b.points[j] - a.points[i]).squaredNorm() < before) nearest = j;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = double{1} * a.colors[i][c] - b.colors[nearest][c];
      out.mean += std::abs(difference) / 3;
      out.brightness += difference / 3;
    }
  }
  const double count = std::ceil(static_cast<double>(a.size()) / 10);
  return {out.mean / count, out.brightness / count};
}

// The same scans: BOP's meshes are shifted, and their vertices have means of the texture.
TEST(TexturedScan, ColorsAgreeWithThoseOfTheVertices) {
  const std::string data = test::real_data();
  if (data.empty() || !std::filesystem::exists(data + "/textured")) {
    GTEST_SKIP() << "no real data";
  }
  struct Scan {
    const char *folder, *ply;
    Eigen::Vector3f shift;  // metres, between the lower corners of their bounding boxes
  };
  for (const Scan& scan :
       {Scan{"cracker_box", "obj_000002", {0.012296f, 0.012409f, -0.108309f}},
        Scan{"power_drill", "obj_000015", {0.036953f, -0.031545f, -0.023305f}}}) {
    SCOPED_TRACE(scan.folder);
    const auto textured = read_mesh_file(data + "/textured/" + scan.folder + "/textured.obj");
    const auto painted = read_mesh(data + "/ycbv/models/" + scan.ply + ".ply", 0.001);
    ASSERT_TRUE(textured.ok() && painted.ok());
    EXPECT_TRUE(textured->warnings.empty());
    modeling::ModelOptions options;
    options.spacing_m = 0.004;
    const auto of_image = modeling::model_source_from_mesh(textured->mesh, "image", 1, options);
    const auto of_vertices = modeling::model_source_from_mesh(*painted, "vertices", 2, options);
    ASSERT_TRUE(of_image.ok() && of_vertices.ok());
    PointCloud shifted = of_image->surface;
    for (Eigen::Vector3f& point : shifted.points) point += scan.shift;
    const ColorDifference same = compare(shifted, of_vertices->surface);
    // What colours in the wrong places differ by.
    PointCloud wrong = shifted;
    for (Eigen::Vector3f& point : wrong.points) point.z() = -point.z();
    const ColorDifference other = compare(wrong, of_vertices->surface);
    std::printf("%s: %.2f (brightness %.2f), upside down %.2f\n", scan.folder, same.mean,
                same.brightness, other.mean);
    EXPECT_LT(same.mean, 0.4 * other.mean);
    EXPECT_LT(std::abs(same.brightness), 3);
  }
}

}  // namespace
}  // namespace bpa::io
