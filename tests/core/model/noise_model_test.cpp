// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/noise_model.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/cloud/surface_map.hpp"

namespace bpa {
namespace {

TEST(NoiseModel, RisesTowardsEdgesAndGrazingAngles) {
  const NoiseModel noise = usual_noise();
  for (const NoiseCurve& curve : {noise.range, noise.normal}) {
    for (double e = 0; e < 0.03; e += 0.002) {
      for (double a = 0; a < 1.5; a += 0.1) {
        EXPECT_GE(curve(e, a), curve(e + 0.002, a));
        EXPECT_LE(curve(e, a), curve(e, a + 0.1));
        EXPECT_GE(curve(e, a), curve.floor);
      }
    }
    const double no_edge = curve(std::numeric_limits<double>::infinity(), 0);
    EXPECT_NEAR(no_edge, curve.floor, 0.05 * curve.floor);
    const double half = curve(curve.edge_place, 0) - no_edge;
    EXPECT_NEAR(half, curve.edge_height / 2, 1e-9);
  }
}

TEST(NoiseModel, GrowsWithDepthAsTheSensorDoes) {
  const NoiseModel noise = usual_noise();
  const double near = noise.range_sigma(0.01, 0.5, noise.depth);
  EXPECT_NEAR(near, noise.range(0.01, 0.5), 1e-12);
  EXPECT_NEAR(noise.range_sigma(0.01, 0.5, 2.0) / near,
              static_cast<double>(depth_noise(2.0f) / depth_noise(0.78f)), 1e-6);
}

TEST(NoiseTable, IsTheCurvesInTheMiddleOfItsCells) {
  const NoiseModel noise = usual_noise();
  const NoiseTable table(noise);
  for (const double cosine : {0.015625, 0.328125, 0.984375}) {
    for (const double edge_distance : {0.001, 0.005, 0.029}) {
      const auto e = static_cast<float>(edge_distance), c = static_cast<float>(cosine);
      const double angle = std::acos(cosine);
      EXPECT_NEAR(table.range(e, c), noise.range(edge_distance, angle), 1e-6);
      EXPECT_NEAR(table.normal(e, c), noise.normal(edge_distance, angle), 1e-5);
    }
  }
  EXPECT_EQ(table.range(5, 0.5f), table.range(0.031f, 0.5f)) << "far from edges";
  EXPECT_EQ(table.normal(0, 1), table.normal(0, 0.99f)) << "seen straight on";
}

}  // namespace
}  // namespace bpa
