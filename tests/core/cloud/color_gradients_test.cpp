// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/color_gradients.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

constexpr int kSize = 48;

// Two colours, divided by a line through the middle whose normal points at `angle`.
Frame divided(double angle) {
  Frame frame;
  frame.camera = {kSize, kSize, 50, 50, 24, 24};
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const bool beyond = std::cos(angle) * (u - 24) + std::sin(angle) * (v - 24) > 0;
      const std::uint8_t red = beyond ? 200 : 40;
      frame.color.insert(frame.color.end(), {red, 60, 60});
    }
  }
  return frame;
}

TEST(ColorGradients, PointAcrossTheLineBetweenTwoColours) {
  for (const double angle : {0.0, 0.5, 1.2, 2.0, 3.1}) {
    const auto gradients = color_gradients(divided(angle), 1);
    const Eigen::Vector2f across(static_cast<float>(std::cos(angle)),
                                 static_cast<float>(std::sin(angle)));
    const Eigen::Vector2f& middle = gradients.at(24, 24);
    EXPECT_GT(middle.norm(), 0.8f) << angle;
    EXPECT_GT(std::abs(middle.normalized().dot(across)), 0.93f) << angle << ": pixels are stairs";
    EXPECT_LT(gradients.at(4, 4).norm(), 1e-3f) << "far from the line";
  }
}

TEST(ColorGradients, StrengthStaysBelowOneAndNoiseIsWeak) {
  Frame frame = divided(0);
  RandomStream random(3);
  for (std::uint8_t& value : frame.color) {
    value = static_cast<std::uint8_t>(100 + std::lround(4 * random.normal()));
  }
  double sum = 0;
  const auto gradients = color_gradients(frame, 1);
  for (const Eigen::Vector2f& gradient : gradients.pixels) {
    EXPECT_LT(gradient.norm(), 1);
    sum += double{gradient.norm()};
  }
  EXPECT_LT(sum / static_cast<double>(gradients.size()), 0.4);
}

TEST(ColorGradients, AreTheSameForAnyNumberOfThreadsAndEmptyWithoutColour) {
  const Frame frame = divided(0.7);
  EXPECT_EQ(color_gradients(frame, 1).pixels, color_gradients(frame, 3).pixels);
  Frame gray = frame;
  gray.color.clear();
  EXPECT_TRUE(color_gradients(gray, 1).empty());
}

}  // namespace
}  // namespace bpa
