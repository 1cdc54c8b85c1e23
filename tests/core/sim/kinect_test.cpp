// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "core/sim/sensor.hpp"

namespace bpa::sim {
namespace {

constexpr double kPi = std::numbers::pi;
const Camera kKinect{320, 240, 570.3, 570.3, 159.5, 119.5};

TriangleMesh quad(double half_width, double half_height) {
  const auto w = static_cast<float>(half_width), h = static_cast<float>(half_height);
  TriangleMesh mesh;
  mesh.vertices = {{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Shading with_material(const Material& material) {
  Shading shading;
  shading.materials.assign(4, material);
  return shading;
}

SensorOptions at_depth_camera() {
  SensorOptions options;
  options.kinect.registered = false;
  return options;
}

// A wide plane through (0, 0, depth), turned about the image's y axis.
SensorImage see_plane(double depth, double angle, const Material& material,
                      const SensorOptions& options, int num_threads = 2, int shot = 0) {
  static const TriangleMesh mesh = quad(20, 20);
  const RayMeshes meshes({&mesh});
  const RayScene scene(
      meshes,
      {{0,
        {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())), {0, 0, depth}}}});
  return simulate_sensor({scene, with_material(material), kKinect, Pose{}}, options, 5, shot,
                         num_threads);
}

// The standard deviation of the measured depth where the plane is `depth` away within 3 %.
double axial_noise(const SensorImage& image, double depth) {
  double sum = 0, squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    if (image.frame.depth[i] == 0 || std::abs(image.ideal.depth[i] / depth - 1) > 0.03) continue;
    const double error = image.frame.depth[i] - image.ideal.depth[i];
    sum += error;
    squares += error * error;
    ++count;
  }
  EXPECT_GT(count, 1500);
  const double mean = sum / count, sigma = std::sqrt(squares / count - mean * mean);
  // A plane that faces the camera may lie between two steps of disparity.
  EXPECT_LT(std::abs(mean), 0.1 * sigma + depth * depth / (570.3 * 0.075) / 16);
  return sigma;
}

double hole_fraction(const SensorImage& image) {
  int holes = 0, all = 0;
  for (int y = 40; y < 200; ++y) {
    for (int x = 60; x < 260; ++x, ++all) holes += image.frame.depth[y * kKinect.width + x] == 0;
  }
  return static_cast<double>(holes) / all;
}

class NoiseOnAPlane : public testing::TestWithParam<std::tuple<double, int>> {};

// Nguyen, Izadi and Lovell 2012, equations 2 and 3, written out anew.
TEST_P(NoiseOnAPlane, IsThePublishedOne) {
  const auto [depth, degrees] = GetParam();
  const double angle = degrees * kPi / 180;
  double expected = 0.0012 + 0.0019 * std::pow(depth - 0.4, 2);
  if (degrees > 60) {
    expected += 0.0001 / std::sqrt(depth) * angle * angle / std::pow(kPi / 2 - angle, 2);
  }
  SensorOptions options = at_depth_camera();
  options.kinect.dropouts = 0;
  const double measured = axial_noise(see_plane(depth, angle, {}, options), depth);
  RecordProperty("measured_um", static_cast<int>(1e6 * measured));
  EXPECT_NEAR(measured / expected, 1, 0.15) << 1e3 * measured << " mm, not " << 1e3 * expected;
}

INSTANTIATE_TEST_SUITE_P(DepthAndAngle, NoiseOnAPlane,
                         testing::Combine(testing::Values(0.6, 1.0, 1.5, 2.0),
                                          testing::Values(0, 30, 50, 70, 75)));

TEST(Kinect, DepthComesInStepsOfAnEighthOfAPixel) {
  const SensorImage image = see_plane(2.0, 0, {}, at_depth_camera());
  std::set<int> levels;
  for (const float depth : image.frame.depth) {
    if (depth > 0) levels.insert(static_cast<int>(std::lround(1e3 * depth)));
  }
  ASSERT_GT(levels.size(), 2u);
  // dz = z^2 / (f b) / 8, in whole millimetres.
  const double step = 1e3 * 4 / (570.3 * 0.075) / 8;
  for (auto it = std::next(levels.begin()); it != levels.end(); ++it) {
    EXPECT_NEAR(*it - *std::prev(it), step, 2.1);
  }
}

TEST(Kinect, ShadowIsAsWideAsTheParallax) {
  const TriangleMesh wall = quad(20, 20), card = quad(0.05, 0.05);
  const RayMeshes meshes({&wall, &card});
  const Eigen::Quaterniond straight = Eigen::Quaterniond::Identity();
  const RayScene scene(meshes, {{0, {straight, {0, 0, 1.0}}}, {1, {straight, {0, 0, 0.6}}}});
  const SensorImage image =
      simulate_sensor({scene, with_material({}), kKinect, Pose{}}, at_depth_camera(), 1);
  const double expected = 570.3 * 0.075 * (1 / 0.6 - 1 / 1.0);
  double left = 0, right = 0;
  int rows = 0;
  for (int y = 100; y < 140; ++y, ++rows) {
    for (int x = 0; x < kKinect.width; ++x) {
      (x < 160 ? left : right) += image.frame.depth[y * kKinect.width + x] == 0;
    }
  }
  EXPECT_NEAR(left / rows, expected, 5);  // the projector stands to the right
  EXPECT_LT(right / rows, 5);
}

TEST(Kinect, LosesGrazingDarkAndShinySurfaces) {
  const SensorOptions options = at_depth_camera();
  const Material matt{0.7, 0}, dark{0.05, 0}, shiny{0.6, 0.9};
  EXPECT_LT(hole_fraction(see_plane(1.0, 0.3, matt, options)), 0.01);
  EXPECT_GT(hole_fraction(see_plane(1.0, 85 * kPi / 180, matt, options)), 0.5);
  EXPECT_LT(hole_fraction(see_plane(0.6, 0, dark, options)), 0.2);
  EXPECT_GT(hole_fraction(see_plane(1.4, 0.5, dark, options)), 0.8);
  EXPECT_GT(hole_fraction(see_plane(1.0, 0, shiny, options)), 0.2);
  EXPECT_LT(hole_fraction(see_plane(1.0, 0.6, shiny, options)), 0.05);
  EXPECT_EQ(hole_fraction(see_plane(5.0, 0, matt, options)), 1);  // out of range
}

TEST(Kinect, WithoutErrorsItIsIdeal) {
  SensorOptions options = at_depth_camera();
  options.kinect.axial_noise = options.kinect.lateral_noise = options.kinect.dropouts = 0;
  options.kinect.disparity_step = 0;
  options.kinect.shadows = false;
  options.color.color_noise = options.color.exposure_spread = 0;
  options.color.white_balance_spread = 0;
  const SensorImage image = see_plane(1.0, 0.8, {}, options);
  for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
    EXPECT_NEAR(image.frame.depth[i], image.ideal.depth[i], 1e-5);
  }
}

// Without any other error, depth is off by what the disparity is, and alike beside each other.
TEST(Kinect, CalibrationErrorIsSmoothAndAsLargeAsAsked) {
  SensorOptions options = at_depth_camera();
  options.kinect.axial_noise = options.kinect.lateral_noise = options.kinect.dropouts = 0;
  options.kinect.disparity_step = 0;
  options.kinect.shadows = false;
  options.kinect.calibration_error = 0.2;
  const double focal_baseline = options.kinect.infrared_focal * options.kinect.baseline;
  double squares = 0, steps = 0;
  int count = 0;
  for (const double depth : {0.7, 0.9, 1.1, 1.3}) {
    const SensorImage image = see_plane(depth, 0, {}, options);
    double last = 0;
    for (std::size_t i = 0; i < image.frame.depth.size(); ++i) {
      const double z = image.frame.depth[i];
      ASSERT_GT(z, 0);
      const double error = focal_baseline / z - focal_baseline / depth;
      if (i % 320 > 0) steps += (error - last) * (error - last);
      squares += error * error;
      last = error;
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.2, 0.1) << "of some tens of independent places";
  EXPECT_LT(std::sqrt(steps / count), 0.02);
}

TEST(Kinect, RegistrationKeepsDepthWhereItIs) {
  SensorOptions options;
  options.kinect.axial_noise = 0.1;
  options.kinect.dropouts = 0;
  const SensorImage image = see_plane(1.0, 0.5, {}, options);
  EXPECT_LT(hole_fraction(image), 1e-3);
  double worst = 0;
  for (int y = 40; y < 200; ++y) {
    for (int x = 60; x < 260; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kKinect.width + x;
      worst = std::max<double>(worst, std::abs(image.frame.depth[i] - image.ideal.depth[i]));
    }
  }
  EXPECT_LT(worst, 0.006);  // a step of quantisation and one pixel of slope
}

TEST(Kinect, AnotherShotHasOtherNoiseAndTheSameErrorsOfTheCamera) {
  SensorOptions options = at_depth_camera();
  options.kinect.calibration_error = 0.4;
  options.color.misregistration = 3;
  const SensorImage first = see_plane(1.0, 0.3, {}, options);
  const SensorImage second = see_plane(1.0, 0.3, {}, options, 2, 1);
  EXPECT_EQ(first.ideal.depth, second.ideal.depth);
  EXPECT_NE(first.frame.depth, second.frame.depth);
  EXPECT_NE(first.frame.color, second.frame.color);
  options.kinect.axial_noise = options.kinect.lateral_noise = options.kinect.dropouts =
      options.color.color_noise = 0;
  const SensorImage third = see_plane(1.0, 0.3, {}, options);
  const SensorImage fourth = see_plane(1.0, 0.3, {}, options, 2, 1);
  EXPECT_NE(third.frame.depth, third.ideal.depth);
  EXPECT_EQ(third.frame.depth, fourth.frame.depth);
  EXPECT_EQ(third.frame.color, fourth.frame.color);
}

// A tilted square before a wall: edges, shadows, grazing surface and noise of every kind.
TEST(Kinect, WantedPixelsAreAsIfAllWere) {
  const TriangleMesh square = quad(0.05, 0.07), wall = quad(20, 20);
  const RayMeshes meshes({&square, &wall});
  const Pose tilted{rotation_from_vector(1.1 * Eigen::Vector3d::UnitY()), {0.02, 0, 0.8}};
  const RayScene scene(meshes, {{0, tilted}, {1, {Eigen::Quaterniond::Identity(), {0, 0, 1.3}}}});
  const Shading shading = with_material({0.5, 0});
  KinectOptions options;
  options.registered = false;
  options.calibration_error = 0.3;
  const Frame all = simulate_depth({scene, shading, kKinect, Pose{}}, options, 7);
  constexpr int kFirst = 100, kLast = 210, kHeight = 150;
  std::vector<std::uint8_t> wanted(all.depth.size(), 0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kFirst; x <= kLast; ++x) wanted[y * kKinect.width + x] = 1;
  }
  const Frame some = simulate_depth({scene, shading, kKinect, Pose{}, wanted}, options, 7);
  int square_pixels = 0;
  for (int y = 0; y < kKinect.height; ++y) {
    for (int x = 0; x < kKinect.width; ++x) {
      const int i = y * kKinect.width + x;
      if (!wanted[i]) {
        EXPECT_EQ(some.depth[i], 0);
      }
      const bool inside = x >= kFirst + kLookAround && x <= kLast - kLookAround &&
                          y < kHeight - kLookAround;  // the image ends above
      if (!inside) continue;
      ASSERT_EQ(some.depth[i], all.depth[i]) << x << ' ' << y;
      square_pixels += all.depth[i] > 0 && all.depth[i] < 1;
    }
  }
  EXPECT_GT(square_pixels, 1000);
}

TEST(Kinect, IsTheSameForAnyNumberOfThreads) {
  SensorOptions options;
  options.color.misregistration = 2;
  const SensorImage one = see_plane(0.9, 0.5, {}, options, 1);
  const SensorImage two = see_plane(0.9, 0.5, {}, options, 2);
  EXPECT_EQ(one.frame.depth, two.frame.depth);
  EXPECT_EQ(one.frame.color, two.frame.color);
}

}  // namespace
}  // namespace bpa::sim
