// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/segment/super_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/cloud/cielab.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/features/edges.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::segment {
namespace {

using test::Solid;

struct Scene {
  SurfaceMap map;
  Image<Eigen::Vector3f> lab;
  Image<float> edges;
};

// A block, a ball and a can on a table, in noisy colours of their own.
Scene table_scene(float noise = 1) {
  const Pose world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  const std::vector<Solid> solids{
      test::table(world),
      {Solid::Kind::box, {0.06, 0.04, 0.05}, world * test::standing_at(-0.1, 0, 0.05, 0.5)},
      {Solid::Kind::sphere, {0.05, 0, 0}, world * test::standing_at(0.05, 0.05, 0.05, 0)},
      {Solid::Kind::cylinder, {0.03, 0, 0.06}, world * test::standing_at(0.05, -0.06, 0.06, 0)}};
  auto image = test::render(solids, test::kinect_camera(), noise, 8);
  const std::array<std::array<int, 3>, 5> colors{
      {{0, 0, 0}, {120, 110, 90}, {180, 40, 40}, {50, 150, 60}, {60, 70, 170}}};
  RandomStream random(3);
  for (const int solid : image.solid) {
    for (const int value : colors[static_cast<std::size_t>(solid + 1)]) {
      image.frame.color.push_back(static_cast<std::uint8_t>(
          std::clamp(value + static_cast<int>(std::lround(5 * random.normal())), 0, 255)));
    }
  }
  Scene scene;
  scene.map = surface_map(image.frame, {});
  const Image<Eigen::Vector3f> rgb = reduced_color(image.frame, scene.map, 1);
  scene.lab = cielab(rgb, 1);
  scene.edges = features::scene_edges(scene.map, rgb).likelihood;
  return scene;
}

// The number of connected parts that some pixels have, where `linked(i, j)` says which neighbours
// hang together: by flooding.
template <class Linked>
int parts_of(const std::set<std::uint32_t>& pixels, int width, const Linked& linked) {
  std::set<std::uint32_t> left = pixels;
  int parts = 0;
  while (!left.empty()) {
    ++parts;
    std::vector<std::uint32_t> open{*left.begin()};
    left.erase(left.begin());
    while (!open.empty()) {
      const std::uint32_t i = open.back();
      open.pop_back();
      const int column = static_cast<int>(i) % width;
      for (const int step : {-1, 1, -width, width}) {
        if ((step == -1 && column == 0) || (step == 1 && column == width - 1)) continue;
        const auto j = static_cast<std::uint32_t>(static_cast<int>(i) + step);
        if (left.count(j) == 0 || !linked(i, j)) continue;
        left.erase(j);
        open.push_back(j);
      }
    }
  }
  return parts;
}

TEST(SuperPixels, PartitionThePixelsWithANormal) {
  const Scene scene = table_scene();
  const Segmentation out = super_pixels(scene.map, scene.lab, scene.edges);
  std::vector<int> owners(scene.map.size(), 0);
  for (std::size_t k = 0; k < out.segments.size(); ++k) {
    const Segment& segment = out.segments[k];
    ASSERT_FALSE(segment.pixels.empty());
    EXPECT_TRUE(std::is_sorted(segment.pixels.begin(), segment.pixels.end()));
    for (const std::uint32_t i : segment.pixels) {
      ++owners[i];
      ASSERT_EQ(out.labels[i], static_cast<int>(k));
    }
  }
  for (std::size_t i = 0; i < scene.map.size(); ++i) {
    const bool has_normal = scene.map.depth[i] > 0 && scene.map.normals[i].squaredNorm() > 0;
    ASSERT_EQ(owners[i], has_normal ? 1 : 0);
    ASSERT_EQ(out.labels[i] >= 0, has_normal);
  }
  EXPECT_GT(out.segments.size(), 500u);
  EXPECT_LT(out.segments.size(), 2000u);
}

TEST(SuperPixels, NoSegmentCrossesAStrongEdgeOrABreak) {
  const Scene scene = table_scene();
  const SuperPixelOptions options;
  const Segmentation out = super_pixels(scene.map, scene.lab, scene.edges, options);
  const auto unbroken = [&](std::size_t i, std::size_t j) {
    return !surface_breaks(scene.map, i, j);
  };
  int with_strong_pixels = 0;
  for (const Segment& segment : out.segments) {
    const std::set<std::uint32_t> all(segment.pixels.begin(), segment.pixels.end());
    std::set<std::uint32_t> core;
    for (const std::uint32_t i : all) {
      if (scene.edges[i] < static_cast<float>(options.strong_edge)) core.insert(i);
    }
    with_strong_pixels += core.size() < all.size();
    ASSERT_EQ(parts_of(all, scene.map.width(), unbroken), 1);
    ASSERT_LE(parts_of(core, scene.map.width(), unbroken), 1);
  }
  EXPECT_GT(with_strong_pixels, 50);
}

TEST(SuperPixels, DescribeThemselves) {
  const Scene scene = table_scene();
  const Segmentation out = super_pixels(scene.map, scene.lab, scene.edges);
  for (std::size_t k = 0; k < out.segments.size(); k += 17) {
    const Segment& segment = out.segments[k];
    Eigen::Vector3d position(0, 0, 0), normal(0, 0, 0), color(0, 0, 0);
    std::vector<std::uint32_t> border;
    for (const std::uint32_t i : segment.pixels) {
      position += scene.map.points[i].cast<double>();
      normal += scene.map.normals[i].cast<double>();
      color += scene.lab[i].cast<double>();
      const int u = static_cast<int>(i) % 320, v = static_cast<int>(i) / 320;
      int same = 0;
      for (const auto& [x, y] : {std::pair(u - 1, v), {u + 1, v}, {u, v - 1}, {u, v + 1}}) {
        same += out.labels.contains(x, y) && out.labels.at(x, y) == static_cast<int>(k);
      }
      if (same < 4) border.push_back(i);
    }
    const auto count = static_cast<double>(segment.pixels.size());
    EXPECT_LT((segment.mean_position.cast<double>() - position / count).norm(), 1e-4);
    EXPECT_LT((segment.mean_normal.cast<double>() - normal.normalized()).norm(), 1e-4);
    EXPECT_LT((segment.mean_color.cast<double>() - color / count).norm(), 1e-2);
    EXPECT_EQ(segment.border, border);
  }
}

TEST(SuperPixels, PairsAreTheContacts) {
  const Scene scene = table_scene();
  const Segmentation out = super_pixels(scene.map, scene.lab, scene.edges);
  struct Sum {
    int contact = 0, breaks = 0;
    double edge = 0;
  };
  std::map<std::pair<int, int>, Sum> expected;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      for (const auto& [x, y] : {std::pair(u + 1, v), std::pair(u, v + 1)}) {
        if (!out.labels.contains(x, y)) continue;
        const std::size_t i = out.labels.index(u, v), j = out.labels.index(x, y);
        if (out.labels[i] < 0 || out.labels[j] < 0 || out.labels[i] == out.labels[j]) continue;
        Sum& sum = expected[std::minmax(out.labels[i], out.labels[j])];
        ++sum.contact;
        sum.breaks += surface_breaks(scene.map, i, j);
        sum.edge += static_cast<double>(std::max(scene.edges[i], scene.edges[j]));
      }
    }
  }
  ASSERT_EQ(out.pairs.size(), expected.size());
  auto next = expected.begin();
  for (const SegmentPair& pair : out.pairs) {
    ASSERT_EQ(std::pair(pair.first, pair.second), next->first);
    EXPECT_EQ(pair.contact, next->second.contact);
    EXPECT_EQ(pair.breaks, next->second.breaks);
    EXPECT_NEAR(pair.edge, next->second.edge / next->second.contact, 1e-4);
    ++next;
  }
}

TEST(SuperPixels, TheSameForAnyNumberOfThreads) {
  const Scene scene = table_scene(2);
  const auto labels = [&](int threads) {
    SuperPixelOptions options;
    options.num_threads = threads;
    return super_pixels(scene.map, scene.lab, scene.edges, options).labels.pixels;
  };
  EXPECT_EQ(labels(1), labels(2));
  EXPECT_EQ(labels(1), labels(7));
}

// A wall of which one half is painted: segments stop at the paint by colour alone.
TEST(SuperPixels, FollowColour) {
  const Solid wall{Solid::Kind::box, {5, 5, 0.05}, {Eigen::Quaterniond::Identity(), {0, 0, 1.05}}};
  const SurfaceMap map = surface_map(test::render({wall}, test::kinect_camera()).frame, {});
  Image<Eigen::Vector3f> lab(320, 240, Eigen::Vector3f(60, 0, 0));
  const auto painted = [](std::size_t i) {
    const int u = static_cast<int>(i) % 320, v = static_cast<int>(i) / 320;
    return 3 * u + v > 600;
  };
  for (std::size_t i = 0; i < lab.size(); ++i) {
    if (painted(i)) lab[i] = {60, 40, 20};
  }
  const Image<float> no_edges(320, 240, 0);
  const auto strays = [&](const Image<Eigen::Vector3f>& colors) {
    std::size_t sum = 0;
    for (const Segment& segment : super_pixels(map, colors, no_edges).segments) {
      const auto count = static_cast<std::size_t>(
          std::count_if(segment.pixels.begin(), segment.pixels.end(), painted));
      sum += std::min(count, segment.pixels.size() - count);
    }
    return sum;
  };
  EXPECT_EQ(strays(lab), 0u);
  EXPECT_GT(strays({}), 200u) << "without colour nothing says where the paint ends";
}

// The same for a fold of 60 degrees.
TEST(SuperPixels, FollowNormals) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(M_PI / 6, Eigen::Vector3d::UnitY()));
  const auto half_wall = [&](const Eigen::Quaterniond& rotation, double side) {
    return Solid{Solid::Kind::box,
                 {1, 2, 0.05},
                 {rotation, Eigen::Vector3d(0, 0, 1) + rotation * Eigen::Vector3d(side, 0, 0.05)}};
  };
  const auto image =
      test::render({half_wall(turn, 1), half_wall(turn.conjugate(), -1)}, test::kinect_camera());
  const SurfaceMap map = surface_map(image.frame, {});
  const Segmentation out = super_pixels(map, {}, Image<float>(320, 240, 0));
  std::size_t strays = 0;
  for (const Segment& segment : out.segments) {
    const auto left = static_cast<std::size_t>(
        std::count_if(segment.pixels.begin(), segment.pixels.end(),
                      [&](std::uint32_t i) { return map.points[i].x() < 0; }));
    strays += std::min(left, segment.pixels.size() - left);
  }
  EXPECT_LT(strays, 240u) << "one pixel a row";
}

TEST(SuperPixels, OfNothingAndOfLittle) {
  EXPECT_TRUE(super_pixels(SurfaceMap(), {}, {}).segments.empty());
  Scene scene = table_scene();
  std::fill(scene.map.normals.begin(), scene.map.normals.end(), Eigen::Vector3f::Zero());
  EXPECT_TRUE(super_pixels(scene.map, scene.lab, scene.edges).segments.empty());
  scene.map.normals[120 * 320 + 160] = -Eigen::Vector3f::UnitZ();
  const Segmentation one = super_pixels(scene.map, scene.lab, scene.edges);
  ASSERT_EQ(one.segments.size(), 1u);
  EXPECT_EQ(one.segments[0].pixels, std::vector<std::uint32_t>{120 * 320 + 160});
  EXPECT_TRUE(one.pairs.empty());
}

TEST(SuperPixels, EverythingOnAStrongEdge) {
  const Scene scene = table_scene();
  const Image<float> all(320, 240, 1);
  const Segmentation out = super_pixels(scene.map, scene.lab, all);
  std::size_t sum = 0;
  for (const Segment& segment : out.segments) sum += segment.pixels.size();
  EXPECT_EQ(sum, static_cast<std::size_t>(
                     std::count_if(scene.map.normals.begin(), scene.map.normals.end(),
                                   [](const Eigen::Vector3f& n) { return n.squaredNorm() > 0; })));
}

}  // namespace
}  // namespace bpa::segment
