// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/cielab.hpp"
#include "core/features/edges.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::features {
namespace {

struct Masks {
  Image<RangeEdge> range{41, 31, RangeEdge::none};
  Image<std::uint8_t> image{41, 31, 0};
  Image<std::uint8_t> curvature{41, 31, 0};
};

TEST(EdgeImage, IsTheWeightedSumOfBlurredLines) {
  Masks masks;
  for (int v = 0; v < 31; ++v) {
    masks.range.at(8, v) = v % 2 == 0 ? RangeEdge::occluding : RangeEdge::occluded;
    masks.curvature.at(20, v) = 1;
    masks.image.at(32, v) = 1;
  }
  EdgeImageOptions options;
  options.blur_px = 1.3;
  options.range_weight = 2;
  options.curvature_weight = 1;
  options.image_weight = 0.5;
  const Image<float> out = edge_image(masks.range, masks.image, masks.curvature, options);
  for (int v = 0; v < 31; ++v) {
    for (int u = 0; u < 41; ++u) {
      const auto line = [&](int at) {
        return std::abs(u - at) <= 4 ? std::exp(-0.5 * (u - at) * (u - at) / (1.3 * 1.3)) : 0.0;
      };
      const double expected = line(8) + 0.5 * line(20) + 0.25 * line(32);
      ASSERT_NEAR(out.at(u, v), std::min(1.0, expected), 2e-5) << u << " " << v;
    }
  }
}

TEST(EdgeImage, StaysWithinOne) {
  Masks masks;
  std::fill(masks.range.pixels.begin(), masks.range.pixels.end(), RangeEdge::occluding);
  std::fill(masks.image.pixels.begin(), masks.image.pixels.end(), std::uint8_t{1});
  for (const float value : edge_image(masks.range, masks.image, masks.curvature).pixels) {
    ASSERT_EQ(value, 1);
  }
  EdgeImageOptions nothing;
  nothing.range_weight = nothing.image_weight = nothing.curvature_weight = 0;
  for (const float value : edge_image(masks.range, masks.image, masks.curvature, nothing).pixels) {
    ASSERT_EQ(value, 0);
  }
}

// The mean likelihood on the true boundary of an object, against that inside of it.
TEST(SceneEdges, AreLikelyOnTheBoundaryOfAnObject) {
  const Pose camera_from_world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  const Pose brick = camera_from_world * test::standing_at(0, 0, test::kBrickHalf.z(), 0.4);
  for (const float noise : {0.0f, 1.0f}) {
    const auto image = test::render({test::table(camera_from_world), test::brick_solid(brick)},
                                    test::kinect_camera(), noise, 4);
    const SurfaceMap map = surface_map(image.frame, {});
    const SceneEdges edges = scene_edges(map, {});
    double border = 0, inside = 0;
    int borders = 0, insides = 0;
    for (int v = 3; v < map.height() - 3; ++v) {
      for (int u = 3; u < map.width() - 3; ++u) {
        const auto is_brick = [&](int x, int y) {
          return image.solid[image.index_of(map, edges.likelihood.index(x, y))] == 1;
        };
        if (!is_brick(u, v)) continue;
        int others = 0;
        for (int y = -3; y <= 3; ++y) {
          for (int x = -3; x <= 3; ++x) others += !is_brick(u + x, v + y);
        }
        const bool touches = !is_brick(u - 1, v) || !is_brick(u + 1, v) || !is_brick(u, v - 1) ||
                             !is_brick(u, v + 1);
        if (touches) border += edges.likelihood.at(u, v), ++borders;
        if (others == 0) inside += edges.likelihood.at(u, v), ++insides;
      }
    }
    ASSERT_GT(borders, 100);
    ASSERT_GT(insides, 500);
    EXPECT_GT(border / borders, 0.55) << noise;
    EXPECT_LT(inside / insides, 0.05) << noise;
  }
}

TEST(SceneEdges, TheSameForAnyNumberOfThreads) {
  const Pose camera_from_world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  auto image = test::render({test::table(camera_from_world)}, test::kinect_camera(), 1, 4);
  RandomStream random(9);
  image.frame.color.resize(3 * image.frame.depth.size());
  for (auto& value : image.frame.color) value = static_cast<std::uint8_t>(random.index(256));
  const SurfaceMap map = surface_map(image.frame, {});
  const auto edges_with = [&](int threads) {
    EdgeImageOptions options;
    options.num_threads = threads;
    return scene_edges(map, reduced_color(image.frame, map, threads), options);
  };
  const SceneEdges one = edges_with(1), four = edges_with(4);
  EXPECT_EQ(one.likelihood.pixels, four.likelihood.pixels);
  EXPECT_EQ(one.image.pixels, four.image.pixels);
  EXPECT_GT(std::count(one.image.pixels.begin(), one.image.pixels.end(), 1), 1000);
}

}  // namespace
}  // namespace bpa::features
