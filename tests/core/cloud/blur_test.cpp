// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/blur.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

Image<float> random_image(int width, int height) {
  Image<float> image(width, height, 0);
  RandomStream random(5);
  for (float& value : image.pixels) value = static_cast<float>(random.uniform());
  return image;
}

// The sum over the square window, in one go and in double precision.
double convolved(const Image<float>& image, int u, int v, double sigma) {
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  double sum = 0, weights = 0;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const double weight = std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
      const int from_u = std::clamp(u + x, 0, image.width - 1);
      const int from_v = std::clamp(v + y, 0, image.height - 1);
      sum += weight * static_cast<double>(image.at(from_u, from_v));
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(Blur, IsTheConvolutionWithAGaussian) {
  const Image<float> image = random_image(37, 23);
  for (const double sigma : {0.5, 1.0, 2.3, 15.0}) {
    const Image<float> out = blur(image, sigma, 1);
    for (int v = 0; v < image.height; v += 3) {
      for (int u = 0; u < image.width; ++u) {
        ASSERT_NEAR(out.at(u, v), convolved(image, u, v, sigma), 1e-5) << sigma;
      }
    }
  }
}

TEST(Blur, ChannelsDoNotMix) {
  const Image<float> image = random_image(31, 18);
  Image<Eigen::Vector3f> colors(31, 18, Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < image.size(); ++i) colors[i] << image[i], 2 * image[i], 7;
  const Image<float> one = blur(image, 1.5, 1);
  const Image<Eigen::Vector3f> three = blur(colors, 1.5, 2);
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_NEAR(three[i][0], one[i], 1e-5);
    ASSERT_NEAR(three[i][1], 2 * one[i], 1e-5);
    ASSERT_NEAR(three[i][2], 7, 1e-4);
  }
}

TEST(Blur, TheSameForAnyNumberOfThreads) {
  const Image<float> image = random_image(64, 200);
  EXPECT_EQ(blur(image, 2, 1).pixels, blur(image, 2, 3).pixels);
}

TEST(Blur, PeakOfALine) {
  Image<float> line(41, 41, 0);
  for (int v = 0; v < 41; ++v) line.at(20, v) = 1;
  for (const double sigma : {0.6, 1.0, 2.5}) {
    EXPECT_NEAR(blur(line, sigma, 1).at(20, 20), blurred_line_peak(sigma), 1e-6);
  }
  EXPECT_EQ(blurred_line_peak(0), 1);
}

TEST(Blur, NothingToDo) {
  const Image<float> image = random_image(5, 4);
  EXPECT_EQ(blur(image, 0, 1).pixels, image.pixels);
  EXPECT_TRUE(blur(Image<float>(), 2, 1).empty());
  const Image<float> dot(1, 1, 3);
  EXPECT_NEAR(blur(dot, 4, 2)[0], 3, 1e-5);
}

}  // namespace
}  // namespace bpa
