// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/match_color.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/cloud/cielab.hpp"

namespace bpa {
namespace {

MatchColor of_linear(double red, double green, double blue) {
  const auto encoded = [](double value) { return static_cast<float>(255 * srgb_of_linear(value)); };
  return match_color(CielabConverter()({encoded(red), encoded(green), encoded(blue)}));
}

TEST(MatchColor, HoldsCielab) {
  const Eigen::Vector3f lab(62, 31, -24);
  const MatchColor color = match_color(lab);
  EXPECT_NEAR(color.root, (62 + 16) / 116.0, 1e-5);
  EXPECT_NEAR(std::exp(color.lightness), color.root, 1e-5);
  EXPECT_NEAR((color.x - 500) * color.root, 31, 1e-3);
  EXPECT_NEAR((200 - color.z) * color.root, -24, 1e-3);
}

TEST(MatchColor, HalfTheLightAgreesAndAHundredthDoesNot) {
  const MatchColor red = of_linear(0.8, 0.2, 0.1);
  EXPECT_TRUE(colors_agree(red, red));
  EXPECT_TRUE(colors_agree(red, of_linear(0.4, 0.1, 0.05)));
  EXPECT_TRUE(colors_agree(of_linear(0.4, 0.1, 0.05), red));
  EXPECT_FALSE(colors_agree(of_linear(0.9, 0.9, 0.9), of_linear(0.009, 0.009, 0.009)));
}

TEST(MatchColor, OtherHuesDisagree) {
  const MatchColor red = of_linear(0.7, 0.1, 0.08), blue = of_linear(0.08, 0.15, 0.7);
  const MatchColor yellow = of_linear(0.7, 0.5, 0.05), grey = of_linear(0.3, 0.3, 0.3);
  EXPECT_FALSE(colors_agree(red, blue));
  EXPECT_FALSE(colors_agree(yellow, blue));
  EXPECT_FALSE(colors_agree(red, grey));
}

TEST(MatchColor, WarmLightAgrees) {
  EXPECT_TRUE(colors_agree(of_linear(0.3, 0.3, 0.3), of_linear(0.36, 0.3, 0.2)));
}

TEST(ColorPalette, HasEachOfFewColours) {
  const std::vector<MatchColor> few = {match_color({50, 60, 40}), match_color({50, 10, -60}),
                                       match_color({80, 0, 0})};
  std::vector<MatchColor> many;
  for (int i = 0; i < 300; ++i) many.push_back(few[i % 3]);
  const std::vector<MatchColor> palette = color_palette(many, 31);
  ASSERT_EQ(palette.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(nearest_color(palette, few[i]), i);
}

TEST(ColorPalette, IsNearEachOfManyColours) {
  RandomStream random(1);
  std::vector<MatchColor> many;
  for (int i = 0; i < 500; ++i) {
    const auto of = [&] { return random.uniform(); };
    many.push_back(of_linear(of(), of(), of()));
  }
  const std::vector<MatchColor> palette = color_palette(many, 31);
  EXPECT_LE(palette.size(), 31u);
  EXPECT_EQ(color_palette(many, 1).size(), 1u);
  float sum = 0;
  for (const MatchColor& color : many) {
    const float near = color_distance(color, palette[nearest_color(palette, color)]);
    for (const MatchColor& other : palette) ASSERT_LE(near, color_distance(color, other));
    sum += near;
  }
  EXPECT_LT(sum / 500, kMaxColorDistance / 4);
}

TEST(ColorPalette, OfNoColoursIsEmpty) { EXPECT_TRUE(color_palette({}, 31).empty()); }

}  // namespace
}  // namespace bpa
