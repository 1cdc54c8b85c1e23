// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Views of a plate with noise that is drawn here, so that what is learned can be compared.
#include "core/modeling/posed_view.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/modeling/trace_occupancy.hpp"

namespace bpa::modeling {
namespace {

constexpr double kHalf = 0.06;  // of the plate's side, metres

// A camera `distance` from the plate's middle, its optical axis `angle` from the plate's normal.
Pose camera_from_plate(double angle, double turn, double distance) {
  const Eigen::Vector3d eye =
      distance * Eigen::Vector3d(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                 std::cos(angle));
  const Eigen::Vector3d forward = -eye.normalized();
  const Eigen::Vector3d right = forward.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  return Pose::from_matrix(axes, eye).inverse();
}

// The plate z = `height` before a background a metre behind it.
PosedView view_of(double angle, double turn, double noise, std::uint64_t seed, double height = 0) {
  Frame frame;
  frame.camera = {200, 200, 570, 570, 99.5, 99.5};
  frame.depth.assign(200 * 200, 0);
  const Pose camera_from = camera_from_plate(angle, turn, 0.8), plate_from = camera_from.inverse();
  RandomStream random(seed);
  for (int v = 0; v < 200; ++v) {
    for (int u = 0; u < 200; ++u) {
      const Eigen::Vector3d d = plate_from.rotation * frame.camera.unproject(u, v, 1);
      const double t = (height - plate_from.translation.z()) / d.z();
      const Eigen::Vector3d at = plate_from.translation + t * d;
      const bool hit = t > 0 && std::max(std::abs(at.x()), std::abs(at.y())) < kHalf;
      const double depth = (hit ? t : 1.8) + noise * random.normal();
      frame.depth[static_cast<std::size_t>(v * 200 + u)] = static_cast<float>(depth);
      frame.color.insert(frame.color.end(), {static_cast<std::uint8_t>(hit ? 200 : 10), 60, 90});
    }
  }
  return make_posed_view(frame, {}, camera_from);
}

PointCloud plate(float spacing) {
  PointCloud cloud;
  for (float y = -0.0595f; y < 0.06f; y += spacing) {
    for (float x = -0.0595f; x < 0.06f; x += spacing) {
      cloud.points.push_back({x, y, 0});
      cloud.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  return cloud;
}

TEST(PosedView, ErrorsAreThoseThatWerePutIn) {
  constexpr double kNoise = 0.004;  // of a pixel; the map's are means of four
  std::vector<PosedView> views;
  for (int k = 0; k < 12; ++k) views.push_back(view_of(0.5, 0.5 * k, kNoise, 10 + k));
  const PointCloud surface = plate(0.0025f);
  const SurfaceObservations seen = observe_surface(surface, views, 2);
  EXPECT_NEAR(seen.depth, 0.8, 0.01);
  double squares = 0, count = 0;
  for (const NoiseBin& bin : seen.range_bins) {
    if (bin.edge_distance < 0.006) continue;
    squares += bin.count * bin.sigma * bin.sigma;
    count += bin.count;
    EXPECT_NEAR(bin.angle, 0.5, 0.1);
  }
  ASSERT_GT(count, 5000);
  EXPECT_NEAR(std::sqrt(squares / count), kNoise / 2, 0.0004);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.points[i].head<2>().cwiseAbs().maxCoeff() > 0.045f) continue;
    EXPECT_EQ(seen.seen[i], 12);
    EXPECT_NEAR(seen.colors[i][0], 200, 1);
    EXPECT_GT(seen.normal_variance[i], 0);
    EXPECT_LT(seen.normal_variance[i], 0.3f * 0.3f);
  }
  const SurfaceObservations again = observe_surface(surface, views, 1);
  EXPECT_EQ(again.normal_variance, seen.normal_variance);
  EXPECT_EQ(again.seen, seen.seen);
}

TEST(PosedView, WhatNoViewMeasuresIsSaid) {
  ModelSource source;
  source.surface = plate(0.0025f);
  const std::size_t front = source.surface.size();
  for (std::size_t i = 0; i < front; ++i) {  // its back, which no camera sees
    source.surface.points.push_back(source.surface.points[i] - Eigen::Vector3f(0, 0, 0.004f));
    source.surface.normals.push_back(-Eigen::Vector3f::UnitZ());
  }
  std::vector<PosedView> views;
  for (int k = 0; k < 6; ++k) views.push_back(view_of(0.4, k, 0.001, 40 + k));
  learn_noise(source, views, 2);
  EXPECT_TRUE(source.noise.fitted);
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_NE(source.warnings[0].find("measured in no view"), std::string::npos);
  EXPECT_EQ(source.normal_variance.size(), source.surface.size());
  for (const float variance : source.normal_variance) EXPECT_GT(variance, 0);
}

// Of a plate with two sides, the one that no camera sees drops out; the other stays where it is.
TEST(PosedView, WhatIsNotMeasuredIsNoPartOfTheModel) {
  ModelSource source;
  source.surface = plate(0.0025f);
  const PointCloud front = source.surface;
  for (const Eigen::Vector3f& p : front.points) {
    source.surface.points.push_back(p - Eigen::Vector3f(0, 0, 0.003f));
    source.surface.normals.push_back(-Eigen::Vector3f::UnitZ());
  }
  ModelSource small = source;  // and one that is nowhere near
  for (Eigen::Vector3f& p : small.surface.points) p.z() += 0.3f;
  std::vector<PosedView> views;
  for (int k = 0; k < 8; ++k) views.push_back(view_of(0.4, 0.8 * k, 0.001, 40 + k));
  for (PosedView& view : views) {
    for (std::size_t i = 0; i < view.object.size(); ++i) view.object[i] = view.map.depth[i] < 1.2f;
  }
  keep_measured(source, views, 2);
  EXPECT_EQ(source.surface.points, front.points);
  EXPECT_EQ(source.surface.normals, front.normals);
  ASSERT_EQ(source.normal_variance.size(), front.size());
  for (const float variance : source.normal_variance) {
    EXPECT_GT(variance, 0);
    EXPECT_LT(variance, 0.6f * 0.6f);
  }
  EXPECT_NEAR(source.diameter, largest_distance(front.points), 1e-9);
  EXPECT_TRUE(source.noise.fitted);
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_NE(source.warnings[0].find("50 % of the surface was measured in no view"),
            std::string::npos);
  ASSERT_NE(source.occupancy, nullptr);
  EXPECT_GT(source.occupancy->cells.size(), 1000u);

  const std::size_t all = small.surface.size();
  keep_measured(small, views, 2);
  EXPECT_EQ(small.surface.size(), all);
  ASSERT_FALSE(small.warnings.empty());
  EXPECT_NE(small.warnings[0].find("hardly sees it"), std::string::npos);
}

// A sheet 3 mm thick, seen from both sides: both surfaces in cells of 5 mm.
TEST(OccupancyGrid, ThinWallFillsBothBuckets) {
  std::vector<PosedView> views;
  for (int k = 0; k < 8; ++k) {
    views.push_back(view_of(0.3, k, 0.0008, 60 + k, 0.0015));
    views.push_back(view_of(M_PI - 0.3, k, 0.0008, 80 + k, -0.0015));
  }
  for (PosedView& view : views) {
    for (std::size_t i = 0; i < view.object.size(); ++i) view.object[i] = view.map.depth[i] < 1.2f;
  }
  const OccupancyGrid grid = trace_occupancy(views, 0.005f, 2);
  int both = 0;
  for (const OccupancyCell& cell : grid.cells) {
    const ViewBucket &a = cell.buckets[0], &b = cell.buckets[1];
    if (a.rays < 5 || b.rays < 5) continue;
    if (a.position.head<2>().cwiseAbs().maxCoeff() > 0.05f) continue;  // rays pass by the rim
    ++both;
    EXPECT_LT(a.normal.dot(b.normal), -0.9f);
    for (const ViewBucket& bucket : cell.buckets) EXPECT_GT(bucket.occupancy, 0.5f);
  }
  EXPECT_GT(both, 200);
  const GridSurface surface = surface_of(grid, 0.003f, 2);
  int up = 0, down = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points.points[i];
    if (p.head<2>().cwiseAbs().maxCoeff() > 0.05f) continue;
    const float side = surface.points.normals[i].z();
    ASSERT_GT(std::abs(side), 0.97f);
    EXPECT_NEAR(p.z(), side > 0 ? 0.0015f : -0.0015f, 0.0007f);
    (side > 0 ? up : down) += 1;
  }
  EXPECT_GT(up, 350);  // a point for each cell
  EXPECT_GT(down, 350);
}

// Something that only one view saw where others look through is not there.
TEST(OccupancyGrid, WhatRaysPassThroughIsEmpty) {
  std::vector<PosedView> views;
  for (int k = 0; k < 8; ++k) views.push_back(view_of(0.3, k, 0.0005, 100 + k));
  views.push_back(view_of(0.0, 0.0, 0.0005, 120, 0.05));  // a plate 5 cm higher
  for (PosedView& view : views) {
    for (std::size_t i = 0; i < view.object.size(); ++i) view.object[i] = view.map.depth[i] < 1.2f;
  }
  const OccupancyGrid grid = trace_occupancy(views, 0.004f, 1);
  int ghosts = 0;
  for (const OccupancyCell& cell : grid.cells) {
    for (const ViewBucket& bucket : cell.buckets) {
      if (bucket.rays < 1 || bucket.position.z() < 0.04f) continue;
      if (bucket.position.head<2>().norm() > 0.04f) continue;
      ++ghosts;
      EXPECT_LT(bucket.occupancy, 0.5f);
    }
  }
  EXPECT_GT(ghosts, 100);
  for (const Eigen::Vector3f& p : surface_of(grid, 0.004f, 1).points.points) {
    if (p.head<2>().norm() > 0.04f) continue;
    EXPECT_LT(p.z(), 0.01f);
  }
}

TEST(OccupancyGrid, OfNothingIsEmpty) {
  EXPECT_TRUE(trace_occupancy({}, 0.003f, 1).cells.empty());
  EXPECT_TRUE(surface_of(OccupancyGrid{}, 0.003f, 1).points.empty());
  EXPECT_FALSE(model_source_from_views({}, "x", 1).ok());
}

}  // namespace
}  // namespace bpa::modeling
