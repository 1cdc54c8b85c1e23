// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/texture.hpp"

#include <gtest/gtest.h>

namespace bpa {
namespace {

/// A right triangle of 1 m whose texture coordinates are `scale` times its x and y.
TriangleMesh triangle(RgbImage image, float scale = 1, const std::array<Wrap, 2>& wrap = {}) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.uv = {{0, 0}, {scale, 0}, {0, scale}};
  mesh.textures = {make_texture(std::move(image), wrap)};
  mesh.texture_of = {0};
  return mesh;
}

/// 64 x 64 pixels; red grows by 4 with x, green with y, blue is a chessboard.
RgbImage ramp() {
  RgbImage image(64, 64, {});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const auto at = [](int value) { return static_cast<std::uint8_t>(value); };
      image.at(x, y) = {at(4 * x), at(4 * y), at((x + y) % 2 == 0 ? 255 : 0)};
    }
  }
  return image;
}

TEST(Texture, FineSamplesInterpolateBetweenTexels) {
  const TriangleMesh mesh = triangle(ramp());
  for (const Eigen::Vector2f& p : {Eigen::Vector2f(0.3f, 0.2f), {0.1f, 0.77f}, {0.55f, 0.4f}}) {
    const Eigen::Vector3f color = color_at(mesh, 0, p, 0.001f);
    // The centre of pixel k is at (k + 0.5) / 64; rows run down.
    EXPECT_NEAR(color[0], 4 * (64 * p.x() - 0.5f), 0.01f);
    EXPECT_NEAR(color[1], 4 * (64 * (1 - p.y()) - 0.5f), 0.01f);
  }
}

TEST(Texture, CoarseSamplesAreMeans) {
  const TriangleMesh mesh = triangle(ramp());
  const Eigen::Vector2f p(0.3f, 0.2f);
  for (const float side : {0.06f, 0.12f, 0.25f}) {
    const Eigen::Vector3f color = color_at(mesh, 0, p, side);
    EXPECT_NEAR(color[0], 4 * (64 * p.x() - 0.5f), 2);
    EXPECT_NEAR(color[2], 127.5f, 1) << "of a chessboard";
  }
  EXPECT_NEAR(color_at(mesh, 0, p, 100)[0], 126, 2) << "of the whole image";
}

TEST(Texture, GoesOnBeyondItsBorders) {
  RgbImage image(4, 1, {});
  for (int x = 0; x < 4; ++x) image.at(x, 0) = {static_cast<std::uint8_t>(50 * x), 0, 0};
  const auto red = [&](Wrap wrap, float x) {
    return color_at(triangle(image, 8, {wrap, wrap}), 0, {x / 8, 0}, 0.0001f)[0];
  };
  EXPECT_NEAR(red(Wrap::repeat, 1.125f), 0, 0.1f);
  EXPECT_NEAR(red(Wrap::repeat, 3.875f), 150, 0.1f);
  EXPECT_NEAR(red(Wrap::repeat, 2), 75, 0.1f) << "between the last pixel and the first";
  EXPECT_NEAR(red(Wrap::mirror, 1.125f), 150, 0.1f);
  EXPECT_NEAR(red(Wrap::mirror, 2.125f), 0, 0.1f);
  EXPECT_NEAR(red(Wrap::clamp, 1.125f), 150, 0.1f);
  EXPECT_NEAR(red(Wrap::clamp, 5), 150, 0.1f);
}

TEST(Texture, ATriangleInsideTheImageHasNothingOfTheOppositeBorder) {
  const TriangleMesh mesh = triangle(ramp());
  EXPECT_EQ(color_at(mesh, 0, {0, 0}, 0.001f)[0], 0);
  EXPECT_EQ(color_at(mesh, 0, {1, 0}, 0.001f)[0], 252);
}

TEST(Texture, OddSizesHalveToOnePixel) {
  const auto texture = make_texture(RgbImage(7, 3, {30, 60, 90}));
  ASSERT_EQ(texture->levels.size(), 3u);
  EXPECT_EQ(texture->levels[1].width, 3);
  EXPECT_EQ(texture->levels[1].height, 1);
  for (const RgbImage& level : texture->levels) {
    for (const auto& rgb : level.pixels) EXPECT_EQ(rgb, (std::array<std::uint8_t, 3>{30, 60, 90}));
  }
}

TEST(Texture, WithoutTextureTheVerticesCount) {
  TriangleMesh mesh = triangle(ramp());
  EXPECT_TRUE(has_colors(mesh));
  mesh.textures.clear();
  EXPECT_FALSE(has_colors(mesh));
  mesh.colors = {{0, 0, 0}, {100, 0, 0}, {0, 200, 0}};
  EXPECT_EQ(color_at(mesh, 0, {0.5f, 0.25f}, 1), Eigen::Vector3f(50, 50, 0));
}

}  // namespace
}  // namespace bpa
