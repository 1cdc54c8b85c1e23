// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/silhouette_score.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/cloud/color_gradients.hpp"

namespace bpa::score {
namespace {

constexpr int kWidth = 80, kHeight = 60;  // of the reduced image; colours have twice as many

PredictedSurface outline_at(int u, int v) {
  return {u, v, Image<float>(20, 20, 0.8f), Image<std::uint32_t>(20, 20, 0u)};
}

CheckImage depth_everywhere(float depth) {
  CheckImage image{kWidth, kHeight, 70, 70, 40, 30, {}, {}};
  image.pixels.assign(kWidth * kHeight, CheckPixel{.depth = depth});
  return image;
}

// The gradients of a red square of 40 x 40 pixels on grey.
Image<Eigen::Vector2f> gradients_of_square(int u, int v) {
  Frame frame;
  frame.camera = {2 * kWidth, 2 * kHeight, 140, 140, 80, 60};
  for (int y = 0; y < 2 * kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; ++x) {
      const bool inside = x >= u && x < u + 40 && y >= v && y < v + 40;
      if (inside) {
        frame.color.insert(frame.color.end(), {180, 30, 30});
      } else {
        frame.color.insert(frame.color.end(), {90, 90, 90});
      }
    }
  }
  return color_gradients(frame, 1);
}

TEST(SilhouetteScore, FallsAsTheOutlineLeavesTheOneInTheImage) {
  const auto gradients = gradients_of_square(60, 40);
  const CheckImage image = depth_everywhere(0.8f);
  const SilhouetteAgreement right = compare_silhouette(image, gradients, outline_at(30, 20));
  EXPECT_GT(right.on, 0.8);
  EXPECT_GT(right.contrast, 0.7);
  EXPECT_GT(compare_silhouette(image, gradients, outline_at(31, 20)).on, 0.9 * right.on);
  // Six pixels beside, the two sides along which it moved still lie on the image's.
  const SilhouetteAgreement beside = compare_silhouette(image, gradients, outline_at(36, 20));
  EXPECT_LT(beside.on, 0.65 * right.on);
  const SilhouetteAgreement off = compare_silhouette(image, gradients, outline_at(40, 30));
  EXPECT_LT(off.on, 0.2);
  EXPECT_LT(off.contrast, 0.1);
}

TEST(SilhouetteScore, WhatIsHiddenDoesNotCount) {
  const auto gradients = gradients_of_square(60, 40);
  CheckImage image = depth_everywhere(0.8f);
  // The wrong half of the outline lies behind something near.
  const double before = compare_silhouette(image, gradients, outline_at(38, 20)).on;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 44; u < kWidth; ++u) {
      image.pixels[static_cast<std::size_t>(v * kWidth + u)].depth = 0.5f;
    }
  }
  const double after = compare_silhouette(image, gradients, outline_at(38, 20)).on;
  EXPECT_NE(after, before);
  EXPECT_TRUE(
      std::isnan(compare_silhouette(depth_everywhere(0.5f), gradients, outline_at(30, 20)).on));
}

TEST(SilhouetteScore, IsNotKnownWithoutColours) {
  const SilhouetteAgreement none =
      compare_silhouette(depth_everywhere(0.8f), {}, outline_at(30, 20));
  EXPECT_TRUE(std::isnan(none.on));
  EXPECT_TRUE(std::isnan(none.contrast));
}

}  // namespace
}  // namespace bpa::score
