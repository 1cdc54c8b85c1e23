// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/active_stereo.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/sensor_scenes.hpp"

namespace bpa::sim {
namespace {

const SensorOptions kStereo = sensor_of(SensorKind::active_stereo);

class StereoNoiseAt : public testing::TestWithParam<double> {};

// z^2 * 0.08 px / (f b), and the steps of a millimetre and of 1/32 pixel.
TEST_P(StereoNoiseAt, IsThePublishedOne) {
  const double depth = GetParam();
  const double metres_per_pixel = depth * depth / (924 * 0.055);
  const double steps = (1e-6 + std::pow(metres_per_pixel / 32, 2)) / 12;
  const double expected = std::sqrt(std::pow(0.08 * metres_per_pixel, 2) + steps);
  const DepthError error = depth_error(see({wide_plane(depth)}, kStereo), 100, 310);
  EXPECT_GT(error.count, 40000);
  EXPECT_NEAR(error.deviation / expected, 1, 0.12);
  EXPECT_LT(std::abs(error.mean), 0.1 * expected);
}

INSTANTIATE_TEST_SUITE_P(Depths, StereoNoiseAt, testing::Values(0.6, 1.0, 1.5, 2.0));

TEST(ActiveStereo, DepthComesInStepsOfOneThirtySecondOfAPixel) {
  SensorOptions options = kStereo;
  const SensorImage image = see({wide_plane(3)}, options);
  for (const float depth : image.frame.depth) {
    if (depth <= 0) continue;
    const double disparity = 924 * 0.055 / depth;
    const double rounding = 32 * 924 * 0.055 / (3 * 3) * 0.0005 * 1.1;  // of a millimetre, steps
    EXPECT_NEAR(32 * disparity, std::round(32 * disparity), rounding + 1e-3);
  }
}

TEST(ActiveStereo, SilhouettesGrowByAFewPixels) {
  const double side = 924 * 0.08 / 0.8;  // of the square, pixels
  EXPECT_NEAR(side * std::sqrt(relative_size(kStereo)), side + 2 * 2.3, 1);
  EXPECT_NEAR(relative_size(sensor_of(SensorKind::structured_light)), 1, 0.02);
  SensorOptions thin = kStereo;
  thin.active_stereo.fattening = 0;
  EXPECT_LT(relative_size(thin), 1.001);
}

// The right camera does not see a strip left of the square; the window covers 2 pixels or so.
TEST(ActiveStereo, HolesAreAsWideAsTheParallax) {
  const SensorImage image = see(
      {wide_plane(1.2), {0.04, 0.04, {Eigen::Quaterniond::Identity(), {0.02, 0, 0.8}}}}, kStereo);
  const double parallax = 924 * 0.055 * (1 / 0.8 - 1 / 1.2);
  const int first = static_cast<int>(924 * 0.055 / 1.2) + 1, middle = 182;
  double left = 0, right = 0;
  for (int y = 100; y < 140; ++y) {
    for (int x = first; x < 320; ++x) {
      (x < middle ? left : right) += image.frame.depth[y * 320 + x] == 0;
    }
  }
  EXPECT_NEAR(left / 40, parallax - 2.3, 1);
  EXPECT_LT(right / 40, 1);
}

// A step of under a pixel of disparity becomes a slope; a Kinect's is as sharp as its pixels.
TEST(ActiveStereo, SmallStepsBecomeSlopes) {
  SensorOptions options = kStereo;
  options.active_stereo.disparity_noise = 0;
  options.active_stereo.dropouts = 0;
  const double step = 0.008;  // metres: 0.4 pixels at 1 m
  const SensorImage image =
      see({wide_plane(1), {10, 20, {Eigen::Quaterniond::Identity(), {10, 0, 1 - step}}}}, options);
  const float* row = image.frame.depth.data() + 120 * 320;
  int between = 0;
  for (int x = 100; x < 300; ++x) between += row[x] > 1 - 0.85 * step && row[x] < 1 - 0.15 * step;
  EXPECT_GE(between, 4);
  EXPECT_LE(between, 9);
}

TEST(ActiveStereo, LosesDarkAndShinySurfaces) {
  const auto measured = [](double depth, const Material& material) {
    return depth_error(see({wide_plane(depth)}, kStereo, material), 100, 310).count / (210.0 * 240);
  };
  EXPECT_GT(measured(1, {0.7, 0}), 0.99);
  EXPECT_LT(measured(2, {0.05, 0}), 0.2);
  EXPECT_LT(measured(1, {0.6, 0.9}), 0.9);
  EXPECT_EQ(depth_error(see({wide_plane(0.4)}, kStereo), 0, 320).count, 0);  // too near
}

TEST(ActiveStereo, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Rectangle> scene{wide_plane(1, 0.4)};
  EXPECT_EQ(see(scene, kStereo, {}, 1).frame.depth, see(scene, kStereo, {}, 2).frame.depth);
}

}  // namespace
}  // namespace bpa::sim
