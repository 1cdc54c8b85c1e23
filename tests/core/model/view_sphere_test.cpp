// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/view_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

// Points evenly spread over a sphere (a Fibonacci lattice).
PointCloud sphere(double radius, int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = M_PI * (3 - std::sqrt(5.0)) * i;
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d normal(r * std::cos(angle), r * std::sin(angle), z);
    cloud.points.push_back((radius * normal).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

TEST(ViewSphere, DirectionsAreSpreadEvenly) {
  const auto directions = view_directions();
  double narrowest = M_PI, widest = 0;
  for (const auto& a : directions) {
    EXPECT_NEAR(a.norm(), 1, 1e-6);
    double nearest = M_PI;
    for (const auto& b : directions) {
      if (&a == &b) continue;
      nearest = std::min(nearest, std::acos(std::clamp(static_cast<double>(a.dot(b)), -1.0, 1.0)));
    }
    narrowest = std::min(narrowest, nearest);
    widest = std::max(widest, nearest);
  }
  // 66 equal discs on the sphere have a radius of 14 degrees.
  EXPECT_GT(narrowest, 17 * M_PI / 180);
  EXPECT_LT(widest, 32 * M_PI / 180);
}

TEST(ViewSphere, NearestViewIsTheNearest) {
  std::vector<ModelView> views(kNumViews);
  const auto directions = view_directions();
  for (std::size_t k = 0; k < views.size(); ++k) views[k].direction = directions[k];
  RandomStream random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3f d = Eigen::Vector3d(random.normal(), random.normal(), random.normal())
                                  .normalized()
                                  .cast<float>();
    const Eigen::Vector3f found = nearest_view(views, d).direction;
    float smallest = 10;
    for (const auto& other : directions) smallest = std::min(smallest, (other - d).norm());
    EXPECT_NEAR((found - d).norm(), smallest, 1e-5);
  }
}

TEST(ViewSphere, HalfOfASphereIsSeen) {
  constexpr double kRadius = 0.05;
  const PointCloud surface = sphere(kRadius, 6000);
  for (const ModelView& view : render_views(surface, 0.003f, 0)) {
    const std::set<std::uint32_t> visible(view.visible.begin(), view.visible.end());
    ASSERT_EQ(visible.size(), view.visible.size());
    for (std::uint32_t i = 0; i < surface.size(); ++i) {
      const float cosine = surface.normals[i].dot(view.direction);
      EXPECT_TRUE(cosine <= 0.1f || visible.count(i) == 1) << cosine;
      EXPECT_TRUE(cosine >= 0 || visible.count(i) == 0) << cosine;
    }
  }
}

TEST(ViewSphere, EdgesOfASphereAreItsOutline) {
  constexpr double kRadius = 0.05;
  constexpr double kSpacing = 0.003;
  const PointCloud surface = sphere(kRadius, 6000);
  for (const ModelView& view : render_views(surface, kSpacing, 0)) {
    ASSERT_EQ(view.outward.size(), view.edges.size());
    std::vector<double> around;
    for (std::size_t k = 0; k < view.edges.size(); ++k) {
      const Eigen::Vector3f& p = surface.points[view.edges[k]];
      const Eigen::Vector3f in_view = p - p.dot(view.direction) * view.direction;
      EXPECT_GT(in_view.norm(), kRadius - 4.5 * kSpacing) << "within a few cells of the outline";
      EXPECT_NEAR(view.outward[k].norm(), 1, 1e-5);
      EXPECT_NEAR(view.outward[k].dot(view.direction), 0, 1e-5);
      EXPECT_GT(view.outward[k].dot(in_view.normalized()), 0.8f);
      const Eigen::Vector3f x = view.direction.unitOrthogonal();
      around.push_back(std::atan2(in_view.dot(view.direction.cross(x)), in_view.dot(x)));
    }
    // All round it, without a gap.
    ASSERT_GT(around.size(), 100u);
    std::sort(around.begin(), around.end());
    for (std::size_t k = 1; k < around.size(); ++k) EXPECT_LT(around[k] - around[k - 1], 0.2);
  }
}

TEST(ViewSphere, EdgeDistancesOfASphereAreThoseToItsOutline) {
  constexpr double kRadius = 0.05;
  constexpr double kSpacing = 0.003;
  const PointCloud surface = sphere(kRadius, 6000);
  int all = 0, close = 0;
  for (const ModelView& view : render_views(surface, kSpacing, 0)) {
    ASSERT_EQ(view.edge_distance.size(), view.visible.size());
    for (std::size_t k = 0; k < view.visible.size(); ++k) {
      const Eigen::Vector3f& p = surface.points[view.visible[k]];
      const float from_axis = (p - p.dot(view.direction) * view.direction).norm();
      const float error = view.edge_distance[k] - (kRadius - from_axis);
      EXPECT_LT(std::abs(error), 2.5 * kSpacing);
      close += std::abs(error) < kSpacing;
      ++all;
    }
  }
  EXPECT_GT(close, 0.99 * all);
}

// A step up counts for what lies beside its foot: the sensor mixes both there.
TEST(ViewSphere, EdgeDistancesCountStepsWithinTheOutline) {
  // A plate of 16 cm, on it a block of 4 cm, 3 cm high, right below the first view.
  const Eigen::Vector3f up = view_directions()[0];
  const Eigen::Vector3f along = up.unitOrthogonal(), across = up.cross(along);
  PointCloud surface;
  std::vector<float> expected;
  for (int k = 0; k < 80 * 80; ++k) {
    const float x = 0.002f * (static_cast<float>(k % 80) - 39.5f);
    const float y = 0.002f * (static_cast<float>(k / 80) - 39.5f);
    const float from_middle = std::max(std::abs(x), std::abs(y));
    const bool block = from_middle < 0.02f;
    surface.points.push_back(x * along + y * across + (block ? 0.03f : 0.0f) * up);
    surface.normals.push_back(up);
    const Eigen::Vector2f beyond(std::abs(x) - 0.02f, std::abs(y) - 0.02f);
    const float to_block = block ? 0.02f - from_middle : beyond.cwiseMax(0.0f).norm();
    expected.push_back(std::min(to_block, 0.08f - from_middle));
  }
  const ModelView view = render_views(surface, 0.003f, 1)[0];
  EXPECT_GT(view.visible.size(), 6200u);
  for (std::size_t k = 0; k < view.visible.size(); ++k) {
    EXPECT_NEAR(view.edge_distance[k], expected[view.visible[k]], 0.006f);
  }
}

TEST(ViewSphere, WhatIsBehindIsHidden) {
  // Two plates that face +z, 5 cm apart; seen from +z the lower one is hidden but for its border.
  PointCloud surface;
  for (int k = 0; k < 50 * 50; ++k) {
    const float x = 0.002f * static_cast<float>(k % 50 - 25);
    const float y = 0.002f * static_cast<float>(k / 50 - 25);
    for (const float z : {0.0f, 0.05f}) {
      surface.points.push_back({x, y, z});
      surface.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  const auto views = render_views(surface, 0.003f, 1);
  const Eigen::Vector3f above = Eigen::Vector3f::UnitZ();
  const ModelView& view = nearest_view(views, above);
  ASSERT_GT(view.direction.z(), 0.97f);
  int lower = 0, upper = 0;
  for (const std::uint32_t i : view.visible) (surface.points[i].z() > 0.02f ? upper : lower) += 1;
  EXPECT_EQ(upper, 2500);
  EXPECT_LT(lower, 700);  // what the slanted view shows beside the upper one
}

TEST(ViewSphere, OfNothingSeesNothing) {
  const auto views = render_views(PointCloud{}, 0.003f, 1);
  ASSERT_EQ(views.size(), static_cast<std::size_t>(kNumViews));
  for (const ModelView& view : views) EXPECT_TRUE(view.visible.empty());
}

}  // namespace
}  // namespace bpa
