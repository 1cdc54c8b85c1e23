// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "core/cloud/blur.hpp"
#include "core/cloud/cielab.hpp"
#include "core/features/edges.hpp"
#include "core/segment/super_pixels.hpp"
#include "core/sim/scenes.hpp"

// Super-pixels of simulated piles against the true masks of their instances.

namespace bpa::segment {
namespace {

// Instance by map pixel, -1 on everything else.
Image<int> true_labels(const sim::SimulatedFrame& view, const SurfaceMap& map) {
  Image<int> labels(map.width(), map.height(), -1);
  for (int v = 0; v < labels.height; ++v) {
    for (int u = 0; u < labels.width; ++u) {
      const int index = v * map.reduction * view.frame.camera.width + u * map.reduction;
      labels.at(u, v) = view.instance_image[static_cast<std::size_t>(index)];
    }
  }
  return labels;
}

bool is_border(const Image<int>& labels, int u, int v) {
  const int here = labels.at(u, v);
  return (u + 1 < labels.width && labels.at(u + 1, v) != here) ||
         (v + 1 < labels.height && labels.at(u, v + 1) != here);
}

struct Quality {
  int boundary = 0;            // pixels on a true boundary
  int recalled = 0;            // those with a segment's border within a pixel
  std::size_t pixels = 0;      // in segments
  std::size_t strays = 0;      // of another instance than most of their segment
  int borders = 0;             // pixels on a segment's border
  double same = 0, cross = 0;  // affinities of pairs within and across objects
  int sames = 0, crosses = 0;
};

void add_borders(const Image<int>& truth, const Image<int>& labels, Quality& sum) {
  for (int v = 1; v < truth.height - 1; ++v) {
    for (int u = 1; u < truth.width - 1; ++u) {
      sum.borders += is_border(labels, u, v);
      if (!is_border(truth, u, v)) continue;
      bool near = false, seen = false;
      for (int y = v - 1; y <= v + 1; ++y) {
        for (int x = u - 1; x <= u + 1; ++x) {
          near |= is_border(labels, x, y);
          seen |= labels.at(x, y) >= 0;
        }
      }
      if (!seen) continue;
      ++sum.boundary;
      sum.recalled += near;
    }
  }
}

void add_segments(const Image<int>& truth, const Segmentation& out, Quality& sum) {
  std::vector<int> owner;
  for (const Segment& segment : out.segments) {
    std::map<int, std::size_t> counts;
    for (const std::uint32_t i : segment.pixels) ++counts[truth[i]];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](auto& a, auto& b) { return a.second < b.second; });
    sum.pixels += segment.pixels.size();
    sum.strays += segment.pixels.size() - most->second;
    owner.push_back(most->first);
  }
  for (const SegmentPair& pair : out.pairs) {
    const int a = owner[static_cast<std::size_t>(pair.first)];
    const int b = owner[static_cast<std::size_t>(pair.second)];
    if (a != b) sum.cross += pair.affinity, ++sum.crosses;
    if (a == b && a >= 0) sum.same += pair.affinity, ++sum.sames;
  }
}

Quality quality_of(int first_scene, int scenes) {
  const sim::Stage stage(sim::household_objects(
      {"mug", "bowl", "can", "cereal_box", "milk_carton", "funnel", "l_brick", "banana"}));
  sim::SceneOptions options;
  options.min_objects = options.max_objects = 10;
  options.min_clutter = 0.6;
  options.max_clutter = 1;
  options.bin_share = 0;
  options.max_distance = 0.9;
  Quality sum;
  for (int k = first_scene; k < first_scene + scenes; ++k) {
    const auto scene = sim::simulate_scene(stage, options, sim::scene_seed(5, k));
    Frame frame = scene.frames.front().frame;
    clean_depth(frame);
    const SurfaceMap map = surface_map(frame, {});
    const Image<Eigen::Vector3f> rgb = reduced_color(frame, map, 0);
    const Image<float> edges = features::scene_edges(map, rgb).likelihood;
    const Segmentation out = super_pixels(map, cielab(blur(rgb, 1.5, 0), 0), edges);
    const Image<int> truth = true_labels(scene.frames.front(), map);
    add_borders(truth, out.labels, sum);
    add_segments(truth, out, sum);
  }
  return sum;
}

TEST(BoundaryRecall, OfSimulatedPiles) {
  const Quality q = quality_of(0, 2);
  ASSERT_GT(q.boundary, 1000);
  const double recall = static_cast<double>(q.recalled) / q.boundary;
  const double strays = static_cast<double>(q.strays) / static_cast<double>(q.pixels);
  RecordProperty("recall", std::to_string(recall));
  RecordProperty("strays", std::to_string(strays));
  RecordProperty("affinity_within", std::to_string(q.same / q.sames));
  RecordProperty("affinity_across", std::to_string(q.cross / q.crosses));
  EXPECT_GT(recall, 0.94);
  EXPECT_LT(strays, 0.012);
  // Borders everywhere would recall everything.
  EXPECT_LT(q.borders, 0.35 * 2 * 320 * 240);
  EXPECT_GT(q.same / q.sames, 0.3);
  EXPECT_LT(q.cross / q.crosses, 0.06);
}

}  // namespace
}  // namespace bpa::segment
