// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/time_of_flight.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/sensor_scenes.hpp"

namespace bpa::sim {
namespace {

const SensorOptions kFlight = sensor_of(SensorKind::time_of_flight);
using std::numbers::pi;

SensorOptions without_noise() {
  SensorOptions options = kFlight;
  options.time_of_flight.axial_noise = options.time_of_flight.dropouts = 0;
  return options;
}

class FlightNoiseAt : public testing::TestWithParam<std::tuple<double, int>> {};

// Fankhauser et al. 2015, written out anew.
TEST_P(FlightNoiseAt, IsThePublishedOne) {
  const auto [depth, degrees] = GetParam();
  const double angle = degrees * pi / 180;
  const double expected =
      1e-3 * (1.5 - 0.5 * depth + 0.3 * depth * depth +
              0.1 * depth * std::sqrt(depth) * std::pow(angle / (pi / 2 - angle), 2));
  const SensorImage image = see({wide_plane(depth, angle)}, kFlight);
  const DepthError error = depth_error(image, 150, 170);
  EXPECT_GT(error.count, 4000);
  EXPECT_NEAR(error.deviation / expected, 1, 0.12);
  EXPECT_LT(std::abs(error.mean), 0.1 * expected);
}

INSTANTIATE_TEST_SUITE_P(DepthAndAngle, FlightNoiseAt,
                         testing::Combine(testing::Values(0.6, 1.0, 2.0, 3.0),
                                          testing::Values(0, 30, 60)));

// Shot noise: with a quarter of the light there is twice the noise.
TEST(TimeOfFlight, NoiseGrowsAsLightFades) {
  const auto noise = [](double infrared) {
    return depth_error(see({wide_plane(1)}, kFlight, {infrared, 0}), 0, 320).deviation;
  };
  EXPECT_NEAR(noise(0.2) / noise(0.8), 2, 0.1);
}

TEST(TimeOfFlight, FlyingPixelsLieBetweenBothSurfaces) {
  const std::vector<Rectangle> scene{wide_plane(1.2),
                                     {0.1, 0.1, {Eigen::Quaterniond::Identity(), {0, 0, 1}}}};
  SensorOptions options = without_noise();
  options.time_of_flight.multipath = 0;
  const auto flying = [&](const SensorOptions& with) {
    const auto between = [](float z) { return z > 1.02f && z < 1.18f; };
    return std::ranges::count_if(see(scene, with).frame.depth, between);
  };
  const double edge = 4 * 0.2 * infrared_focal(options);  // pixels around the square
  EXPECT_NEAR(static_cast<double>(flying(options)) / edge, 2, 0.3);
  const SensorImage image = see(scene, options);
  EXPECT_GT(std::ranges::min(image.frame.depth), 0.998f);
  EXPECT_LT(std::ranges::max(image.frame.depth), 1.202f);
  options.time_of_flight.flying_pixels = false;
  EXPECT_EQ(flying(options), 0);
}

TEST(TimeOfFlight, PhasesThatCancelGiveNoDepth) {
  SensorOptions options = kFlight;
  options.time_of_flight.multipath = 0;
  const SensorImage image =
      see({wide_plane(1.8), {0.1, 0.1, {Eigen::Quaterniond::Identity(), {0, 0, 1}}}}, options);
  EXPECT_GT(std::ranges::count(image.frame.depth, 0.0f), 200);
}

TEST(TimeOfFlight, ABounceMovesACornerAwayAndLeavesAPlane) {
  const SensorOptions options = without_noise();
  const DepthError plane = depth_error(see({wide_plane(1, 0.5)}, options), 20, 300);
  EXPECT_LT(std::abs(plane.mean), 2e-4);
  EXPECT_LT(plane.deviation, 2e-3);
  // Two walls that meet at a right angle before the camera, 1 m away.
  const auto wall = [](double side) -> Rectangle {
    const Pose turn{rotation_from_vector(side * pi / 4 * Eigen::Vector3d::UnitY()),
                    Eigen::Vector3d(0, 0, 1)};
    return {0.3, 0.3, turn * Pose{Eigen::Quaterniond::Identity(), {side * 0.3, 0, 0}}};
  };
  const std::vector<Rectangle> corner{wall(1), wall(-1)};
  const DepthError bounced = depth_error(see(corner, options), 100, 220);
  EXPECT_GT(bounced.mean, 0.003);
  EXPECT_LT(bounced.mean, 0.06);
  SensorOptions alone = options;
  alone.time_of_flight.multipath = 0;
  EXPECT_LT(std::abs(depth_error(see(corner, alone), 100, 220).mean), 5e-4);
}

TEST(TimeOfFlight, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Rectangle> scene{wide_plane(1.2, 0.4),
                                     {0.1, 0.1, {Eigen::Quaterniond::Identity(), {0, 0, 0.9}}}};
  EXPECT_EQ(see(scene, kFlight, {}, 1).frame.depth, see(scene, kFlight, {}, 2).frame.depth);
}

}  // namespace
}  // namespace bpa::sim
