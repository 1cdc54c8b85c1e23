// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Models of meshes are what a simulated camera sees of them.
#include <gtest/gtest.h>

#include "core/model/occupancy_grid.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"
#include "tools/posed_views.hpp"

namespace bpa::cli {
namespace {

ModelSource whole(const TriangleMesh& mesh) {
  auto source = modeling::model_source_from_mesh(mesh, "thing", 1);
  EXPECT_TRUE(source.ok()) << source.status().message;
  return *source;
}

ModelSource measured(const TriangleMesh& mesh, int views, int num_threads = 2) {
  ModelSource source = whole(mesh);
  modeling::keep_measured(source, simulate_views(mesh, views, 1, num_threads, {}), num_threads);
  return source;
}

bool warns_of_unseen(const ModelSource& source) {
  for (const std::string& warning : source.warnings) {
    if (warning.find("measured in no view and was left out") != std::string::npos) return true;
  }
  return false;
}

TEST(SimulatedViews, BoxIsSeenWhole) {
  const TriangleMesh mesh = test::box_mesh({0.05f, 0.04f, 0.025f});
  const ModelSource seen = measured(mesh, 40), all = whole(mesh);
  EXPECT_GE(seen.surface.size(), all.surface.size() * 995 / 1000);
  EXPECT_FALSE(warns_of_unseen(seen));
  // Normals vary little in the middle of a face, much at its edge.
  double middle = 0, edge = 0, in_middle = 0, at_edge = 0;
  for (std::size_t i = 0; i < seen.surface.size(); ++i) {
    const Eigen::Vector3f& p = seen.surface.points[i];
    if (std::abs(p.z()) < 0.0249f) continue;
    const float inside = std::min(0.05f - std::abs(p.x()), 0.04f - std::abs(p.y()));
    const auto variance = static_cast<double>(seen.normal_variance[i]);
    if (inside > 0.02f) middle += variance, ++in_middle;
    if (inside < 0.002f) edge += variance, ++at_edge;
  }
  ASSERT_GT(in_middle, 50);
  ASSERT_GT(at_edge, 50);
  EXPECT_GT(edge / at_edge, 3 * middle / in_middle);
}

// What time and memory grow with: the pixels of a view.
TEST(SimulatedViews, LargeObjectsHaveNoLargerImages) {
  for (const float side : {1.0f, 1.7f}) {
    const TriangleMesh mesh = test::box_mesh(Eigen::Vector3f::Constant(side / 2));
    for (const modeling::PosedView& view : simulate_views(mesh, 2, 1, 2, {})) {
      EXPECT_LE(view.map.size(), 280u * 280u);
      EXPECT_GT(std::ranges::count(view.object, 1), 10000);
    }
  }
}

// No camera that does not look straight in sees the bottom of a narrow tube; what is inside of
// another solid is no news.
TEST(SimulatedViews, BottomOfATubeIsLeftOut) {
  TriangleMesh mesh = test::cup_mesh(0.02, 0.003, 0.2);
  const ModelSource seen = measured(mesh, 40);
  EXPECT_TRUE(warns_of_unseen(seen));
  const auto floor_points = [](const ModelSource& source) {
    int count = 0;
    for (std::size_t i = 0; i < source.surface.size(); ++i) {
      const Eigen::Vector3f& p = source.surface.points[i];
      count += p.z() > 0.001f && p.z() < 0.006f && source.surface.normals[i].z() > 0.9f;
    }
    return count;
  };
  EXPECT_GT(floor_points(whole(mesh)), 20);
  EXPECT_EQ(floor_points(seen), 0);

  TriangleMesh box = test::box_mesh({0.05f, 0.04f, 0.04f});
  test::add_box(box, {0.03f, 0.02f, 0.02f});
  EXPECT_FALSE(warns_of_unseen(measured(box, 40)));
}

TEST(SimulatedViews, WallOfABeakerKeepsBothSides) {
  const TriangleMesh mesh = test::cup_mesh(0.045, 0.004, 0.07);
  const ModelSource seen = measured(mesh, 80);
  int outside = 0, inside = 0;
  for (std::size_t i = 0; i < seen.surface.size(); ++i) {
    const Eigen::Vector3f& p = seen.surface.points[i];
    if (p.z() < 0.03f || p.z() > 0.06f) continue;
    const float out = seen.surface.normals[i].head<2>().dot(p.head<2>().normalized());
    outside += out > 0.9f;
    inside += out < -0.9f;
  }
  EXPECT_GT(outside, 800);
  EXPECT_GT(inside, 700);
}

// A beaker scanned upright and upside down from halfway up: its outside is complete, but nobody has
// looked down to its inner floor.
TEST(SimulatedViews, InnerFloorThatNobodySawIsSaid) {
  const TriangleMesh mesh = test::cup_mesh(0.04, 0.004, 0.095);
  const std::vector<modeling::PosedView> all = simulate_views(mesh, 150, 1, 2, {});
  std::vector<modeling::PosedView> halfway;
  for (const modeling::PosedView& view : all) {
    const Eigen::Vector3d eye = view.camera_from_object.inverse().translation;
    const double up = std::abs((eye - Eigen::Vector3d(0, 0, 0.0475)).normalized().z());
    if (up > 0.35 && up < 0.72) halfway.push_back(view);
  }
  ASSERT_GT(halfway.size(), 40u);
  const auto warnings = [](const std::vector<modeling::PosedView>& views) {
    const auto model = modeling::model_source_from_views(views, "beaker", 1);
    EXPECT_TRUE(model.ok()) << model.status().message;
    std::string text;
    for (const std::string& warning : model->warnings) text += warning + "\n";
    return text;
  };
  EXPECT_EQ(warnings(all), "");
  EXPECT_NE(warnings(halfway).find("was never seen, most of it from +z"), std::string::npos)
      << warnings(halfway);
}

// Of a point cloud the camera sees squares about the points: whole, and where they are.
TEST(SimulatedViews, PointCloudIsSeenWhole) {
  ModelSource source = whole(test::sphere_mesh(0.04));
  const PointCloud all = source.surface;
  const TriangleMesh squares = squares_of(all);
  ASSERT_EQ(squares.triangles.size(), 2 * all.size());
  const std::vector<modeling::PosedView> views = simulate_views(squares, 40, 1, 2, {});
  double off = 0, count = 0;
  for (const modeling::PosedView& view : views) {
    const Pose sphere_from_camera = view.camera_from_object.inverse();
    for (std::size_t i = 0; i < view.map.size(); ++i) {
      if (!view.object[i] || !(view.map.depth[i] > 0)) continue;
      off += (sphere_from_camera * view.map.points[i].cast<double>()).norm() - 0.04;
      ++count;
    }
  }
  ASSERT_GT(count, 10000);
  EXPECT_NEAR(off / count, 0, 0.001);
  modeling::keep_measured(source, views, 2);
  EXPECT_GE(source.surface.size(), all.size() * 99 / 100);
  EXPECT_TRUE(source.noise.fitted);
  EXPECT_LT(source.noise.range(0.05, 0), 0.003);
}

TEST(SimulatedViews, SameModelForAnyThreads) {
  const TriangleMesh mesh = test::l_mesh();
  const ModelSource one = measured(mesh, 12, 1), two = measured(mesh, 12, 2);
  EXPECT_EQ(one.surface.points, two.surface.points);
  EXPECT_EQ(one.normal_variance, two.normal_variance);
  EXPECT_EQ(one.noise.range.floor, two.noise.range.floor);
  ASSERT_EQ(one.occupancy->cells.size(), two.occupancy->cells.size());
}

}  // namespace
}  // namespace bpa::cli
