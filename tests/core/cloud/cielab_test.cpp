// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/cielab.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

void expect_lab(const Eigen::Vector3f& rgb, const Eigen::Vector3f& lab) {
  EXPECT_LT((CielabConverter()(rgb) - lab).norm(), 0.1f)
      << rgb.transpose() << " is " << CielabConverter()(rgb).transpose();
}

// Published values (D65, two degrees).
TEST(Cielab, KnownColours) {
  expect_lab({255, 255, 255}, {100, 0, 0});
  expect_lab({0, 0, 0}, {0, 0, 0});
  expect_lab({255, 0, 0}, {53.24f, 80.09f, 67.20f});
  expect_lab({0, 255, 0}, {87.73f, -86.18f, 83.18f});
  expect_lab({0, 0, 255}, {32.30f, 79.19f, -107.86f});
  expect_lab({128, 128, 128}, {53.59f, 0, 0});
}

// The definition, without tables.
Eigen::Vector3d defined(const Eigen::Vector3d& rgb) {
  const auto linear = [](double value) {
    value /= 255;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  Eigen::Matrix3d xyz_from_rgb;
  xyz_from_rgb << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339,
      0.1191920, 0.9503041;
  const Eigen::Vector3d xyz =
      (xyz_from_rgb * rgb.unaryExpr(linear)).cwiseQuotient(Eigen::Vector3d(0.95047, 1, 1.08883));
  const auto f = [](double t) {
    return t > std::pow(6.0 / 29, 3) ? std::cbrt(t) : t / (3 * std::pow(6.0 / 29, 2)) + 4.0 / 29;
  };
  const double x = f(xyz.x()), y = f(xyz.y()), z = f(xyz.z());
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(Cielab, TablesAreTheDefinition) {
  const CielabConverter convert;
  RandomStream random(3);
  for (int i = 0; i < 20000; ++i) {
    const double top = i % 2 == 0 ? 255 : 20;  // dark colours are where the root bends
    const Eigen::Vector3d rgb(random.uniform(0, top), random.uniform(0, top),
                              random.uniform(0, top));
    // Between whole numbers the table of sRGB is a polygon.
    const Eigen::Vector3d whole = rgb.array().round();
    ASSERT_LT((convert(whole.cast<float>()).cast<double>() - defined(whole)).norm(), 0.05);
    ASSERT_LT((convert(rgb.cast<float>()).cast<double>() - defined(rgb)).norm(), 0.15);
  }
}

TEST(Cielab, ClampsWhatIsNoColour) {
  const CielabConverter convert;
  EXPECT_EQ(convert({300, -5, 256}), convert({255, 0, 255}));
}

TEST(ReducedColor, IsTheMeanOfTheBlock) {
  Frame frame;
  frame.camera = {840, 64, 500, 500, 420, 32};
  frame.depth.assign(840 * 64, 1.0f);
  frame.color.resize(3 * frame.depth.size());
  RandomStream random(4);
  for (auto& value : frame.color) value = static_cast<std::uint8_t>(random.index(256));
  const SurfaceMap map = surface_map(frame, {});
  ASSERT_EQ(map.reduction, 3);
  const Image<Eigen::Vector3f> rgb = reduced_color(frame, map, 2);
  ASSERT_EQ(rgb.width, 280);
  ASSERT_EQ(rgb.height, 21);
  for (const auto& [u, v] : {std::pair(0, 0), std::pair(279, 20), std::pair(100, 7)}) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 3 * v; y < 3 * v + 3; ++y) {
      for (int x = 3 * u; x < 3 * u + 3; ++x) {
        const std::uint8_t* pixel = frame.color.data() + 3 * (y * 840 + x);
        sum += Eigen::Vector3d(pixel[0], pixel[1], pixel[2]);
      }
    }
    EXPECT_LT((rgb.at(u, v).cast<double>() - sum / 9).norm(), 1e-3);
  }
  frame.color.clear();
  EXPECT_TRUE(reduced_color(frame, map, 1).empty());
  EXPECT_TRUE(cielab({}, 1).empty());
}

}  // namespace
}  // namespace bpa
