// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/features/edges.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::features {
namespace {

using test::Solid;

// A box in front of a wall: its silhouette in the map is columns 106..213 and rows 79..160, at
// 1 m; the wall is at 1.5 m.
test::SolidImage box_before_wall(float noise = 0) {
  const Camera camera = test::kinect_camera();
  const Solid wall{Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {0, 0, 1.55}}};
  const double half_width = 0.5 * 216 / 525, half_height = 0.5 * 164 / 525;
  const Solid box{Solid::Kind::box,
                  {half_width, half_height, 0.05},
                  {Eigen::Quaterniond::Identity(), {0, 0, 1.05}}};
  return test::render({wall, box}, camera, noise, 3);
}

bool on_box(int u, int v) { return u >= 106 && u <= 213 && v >= 79 && v <= 160; }

// Of the box, or next to it, by the silhouette alone.
RangeEdge expected_at(int u, int v) {
  const bool inside = on_box(u, v);
  const bool at_border = inside != on_box(u - 1, v) || inside != on_box(u + 1, v) ||
                         inside != on_box(u, v - 1) || inside != on_box(u, v + 1);
  if (!at_border) return RangeEdge::none;
  return inside ? RangeEdge::occluding : RangeEdge::occluded;
}

TEST(RangeEdges, AreTheSilhouetteOfABox) {
  for (const float noise : {0.0f, 1.0f}) {
    const Image<RangeEdge> edges = range_edges(surface_map(box_before_wall(noise).frame, {}));
    ASSERT_EQ(edges.width, 320);
    ASSERT_EQ(edges.height, 240);
    for (int v = 0; v < edges.height; ++v) {
      for (int u = 0; u < edges.width; ++u) {
        ASSERT_EQ(edges.at(u, v), expected_at(u, v)) << u << " " << v << " noise " << noise;
      }
    }
  }
}

TEST(RangeEdges, AcrossAShadowWithoutDepth) {
  test::SolidImage image = box_before_wall();
  for (int v = 0; v < 480; ++v) {
    for (int u = 200; u < 212; ++u) image.frame.depth[static_cast<std::size_t>(640 * v + u)] = 0;
  }
  const SurfaceMap map = surface_map(image.frame, {});  // six columns, 100..105, without depth
  const Image<RangeEdge> edges = range_edges(map, {.max_gap_px = 6});
  for (int v = 85; v < 155; ++v) {
    EXPECT_EQ(edges.at(106, v), RangeEdge::occluding);
    EXPECT_EQ(edges.at(99, v), RangeEdge::occluded);
    for (int u = 100; u < 106; ++u) EXPECT_EQ(edges.at(u, v), RangeEdge::none);
  }
  // Above the box the wall goes on behind the gap.
  EXPECT_EQ(edges.at(99, 30), RangeEdge::none);
  EXPECT_EQ(edges.at(106, 30), RangeEdge::none);
  EXPECT_EQ(range_edges(map, {.max_gap_px = 5}).at(106, 100), RangeEdge::none);
}

TEST(RangeEdges, NoneOnASlopeNorAtACrease) {
  const Pose camera_from_world = test::look_at({0.1, -0.6, 0.35}, {0, 0, 0.05});
  // A block as wide as the table: its foot and its near top edge are creases.
  const Solid wall{
      Solid::Kind::box, {0.7, 0.1, 0.2}, camera_from_world * test::standing_at(0, 0.2, 0.0, 0)};
  const auto image = test::render({test::table(camera_from_world), wall}, test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  const Image<RangeEdge> edges = range_edges(map);
  int marked = 0, looked_at = 0;
  for (int v = 60; v < 240; ++v) {
    for (int u = 60; u < 260; ++u) {
      if (map.depth[edges.index(u, v)] <= 0) continue;
      ++looked_at;
      marked += edges.at(u, v) != RangeEdge::none;
    }
  }
  EXPECT_GT(looked_at, 20000);
  EXPECT_EQ(marked, 0);
}

TEST(RangeEdges, TheSameForAnyNumberOfThreads) {
  const SurfaceMap map = surface_map(box_before_wall(2).frame, {});
  EXPECT_EQ(range_edges(map, {.num_threads = 1}).pixels,
            range_edges(map, {.num_threads = 4}).pixels);
}

TEST(RangeEdges, NothingSeenNothingFound) {
  EXPECT_TRUE(range_edges(SurfaceMap()).empty());
  SurfaceMap map = surface_map(box_before_wall().frame, {});
  std::fill(map.depth.begin(), map.depth.end(), 0.0f);
  const Image<RangeEdge> edges = range_edges(map);
  EXPECT_EQ(std::count(edges.pixels.begin(), edges.pixels.end(), RangeEdge::none), 320 * 240);
}

}  // namespace
}  // namespace bpa::features
