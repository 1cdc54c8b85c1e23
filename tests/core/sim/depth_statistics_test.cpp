// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Statistics of depth images whose every figure is known.
#include "tests/core/sim/depth_statistics.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa::sim {
namespace {

constexpr double kFocal = 570.3, kBaseline = 0.075;

Frame flat_frame(double depth, double focal = kFocal) {
  Frame frame;
  frame.camera = {320, 240, focal, focal, 159.5, 119.5};
  frame.depth.assign(320 * 240, static_cast<float>(depth));
  return frame;
}

float& at(Frame& frame, int x, int y) { return frame.depth[static_cast<std::size_t>(320 * y + x)]; }

void fill(Frame& frame, int left, int top, int width, int height, float depth) {
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) at(frame, x, y) = depth;
  }
}

TEST(DepthStatistics, HolesAreCounted) {
  Frame frame = flat_frame(1);
  fill(frame, 0, 0, 20, 240, 0);    // an unmeasured margin: not counted
  fill(frame, 100, 50, 30, 20, 0);  // 600 pixels: large
  fill(frame, 200, 50, 5, 4, 0);    // 20 pixels: small
  fill(frame, 200, 100, 1, 1, 0);   // small
  fill(frame, 201, 101, 1, 1, 0);   // touches the last at a corner only: another one
  fill(frame, 310, 100, 10, 1, 0);  // at the border: no hole
  const DepthStatistics s = depth_statistics(frame);
  EXPECT_NEAR(s.missing, (600 + 20 + 2 + 10) / (300.0 * 240), 1e-12);
  EXPECT_NEAR(s.small_holes, 3 / (300.0 * 240) * 1e4, 1e-9);
}

TEST(DepthStatistics, GapsAreMeasuredOnBothSides) {
  // A card at 0.7 m before a wall at 1 m, 9 pixels lost on its left and 3 on its right; with twice
  // the focal length pixels count half.
  for (const double zoom : {1.0, 2.0}) {
    Frame frame = flat_frame(1, zoom * kFocal);
    fill(frame, 100, 50, 80, 100, 0.7f);
    fill(frame, 91, 50, 9, 100, 0);
    fill(frame, 180, 50, 3, 100, 0);
    fill(frame, 30, 20, 4, 100, 0);  // not at an edge of anything
    const DepthStatistics s = depth_statistics(frame);
    EXPECT_NEAR(s.left_gap, 9 / zoom, 1e-12);
    EXPECT_NEAR(s.right_gap, 3 / zoom, 1e-12);
  }
}

TEST(DepthStatistics, RoughnessOfATiltedPlaneIsItsNoise) {
  // A plane is linear in disparity; white noise of 0.1 pixels on top.
  Frame frame = flat_frame(1);
  RandomStream random(1, 0);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double disparity = 40 + 0.02 * x - 0.05 * y + 0.1 * random.normal();
      at(frame, x, y) = static_cast<float>(kFocal * kBaseline / disparity);
    }
  }
  const DepthStatistics s = depth_statistics(frame);
  EXPECT_NEAR(s.roughness, 0.1, 0.003);
  EXPECT_NEAR(s.near_correlation, 0, 0.03);
  EXPECT_NEAR(s.far_correlation, 0, 0.03);
  EXPECT_EQ(s.missing, 0);
}

TEST(DepthStatistics, NoiseInStripesIsCorrelated) {
  Frame frame = flat_frame(1);
  RandomStream random(2, 0);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; x += 4) {
      const double disparity = 42 + 0.1 * random.normal();
      fill(frame, x, y, 4, 1, static_cast<float>(kFocal * kBaseline / disparity));
    }
  }
  // Blocks of four: half of the points two pixels apart lie in one block.
  const DepthStatistics s = depth_statistics(frame);
  EXPECT_NEAR(s.near_correlation, 0.5, 0.05);
  EXPECT_NEAR(s.far_correlation, 0, 0.05);
}

TEST(DepthStatistics, NothingGivesZeros) {
  const DepthStatistics s = depth_statistics(flat_frame(0));
  EXPECT_EQ(s.missing, 0);
  EXPECT_EQ(s.roughness, 0);
}

TEST(PlaneNoiseOfImages, WithoutErrorsThereIsNone) {
  SensorOptions options;
  options.kinect.axial_noise = options.kinect.lateral_noise = options.kinect.dropouts = 0;
  options.kinect.disparity_step = 0;
  const PlaneNoise noise = plane_noise(1, 0.5, options);
  EXPECT_LT(noise.axial, 1e-5);
  EXPECT_EQ(noise.lateral, 0);
  EXPECT_EQ(noise.missing, 0);
}

// Nguyen, Izadi and Lovell 2012: the lateral noise of a plane that faces the camera is 0.8 pixels.
TEST(PlaneNoiseOfImages, EdgesAreAsRaggedAsPublished) {
  for (const double depth : {0.6, 1.0, 1.5, 2.0}) {
    EXPECT_NEAR(plane_noise(depth, 0.2, {}).lateral, 0.81, 0.2) << depth;
  }
}

}  // namespace
}  // namespace bpa::sim
