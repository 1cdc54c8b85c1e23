// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/features/edges.hpp"

namespace bpa::features {
namespace {

// A bright disc on a darker ground, `step` of luminance above it, with noise.
Image<Eigen::Vector3f> disc(float step, double noise) {
  Image<Eigen::Vector3f> rgb(160, 120, Eigen::Vector3f::Constant(90));
  RandomStream random(2);
  for (int v = 0; v < rgb.height; ++v) {
    for (int u = 0; u < rgb.width; ++u) {
      if (std::hypot(u - 80, v - 60) < 40) rgb.at(u, v).array() += step;
      rgb.at(u, v).array() += static_cast<float>(noise * random.normal());
    }
  }
  return rgb;
}

TEST(ImageEdges, AreTheOutlineOfADisc) {
  const Image<std::uint8_t> edges = image_edges(disc(60, 2));
  std::vector<bool> seen(360, false);
  int marked = 0;
  for (int v = 0; v < edges.height; ++v) {
    for (int u = 0; u < edges.width; ++u) {
      if (!edges.at(u, v)) continue;
      ++marked;
      ASSERT_EQ(edges.at(u, v), 1);
      EXPECT_NEAR(std::hypot(u - 80, v - 60), 39.5, 1.5);
      const double degrees = std::atan2(v - 60, u - 80) * 180 / M_PI + 180;
      for (int d = -2; d <= 2; ++d) {
        seen[static_cast<std::size_t>((static_cast<int>(degrees) + d + 360) % 360)] = true;
      }
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0) << "the outline is closed";
  EXPECT_LT(marked, 2 * M_PI * 40 * 1.3) << "and thin";
}

TEST(ImageEdges, StepsBelowTheThresholdAreNone) {
  const ImageEdgeOptions options{.low = 10, .high = 25};
  const auto count = [&](float step) {
    const Image<std::uint8_t> edges = image_edges(disc(step, 0), options);
    return std::count(edges.pixels.begin(), edges.pixels.end(), 1);
  };
  EXPECT_EQ(count(12), 0);
  EXPECT_GT(count(45), 200);
}

TEST(ImageEdges, WithoutColourNone) { EXPECT_TRUE(image_edges({}).empty()); }

}  // namespace
}  // namespace bpa::features
