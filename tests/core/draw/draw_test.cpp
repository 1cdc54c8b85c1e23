// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/draw/annotate.hpp"
#include "core/draw/poses.hpp"
#include "core/draw/scene_features.hpp"
#include "core/draw/sheet.hpp"

namespace bpa::draw {
namespace {

constexpr int kWidth = 8, kHeight = 4;  // of the maps; frames are twice as large

Frame white_frame() {
  Frame frame;
  frame.camera = {2 * kWidth, 2 * kHeight, 10, 10, 8, 4};
  frame.depth.assign(4 * kWidth * kHeight, 1.0f);
  frame.color.assign(12 * kWidth * kHeight, 255);
  return frame;
}

std::array<int, 3> color_at(const io::ColorImage& image, int u, int v) {
  const std::uint8_t* pixel = image.pixels.data() + 3 * (v * image.width + u);
  return {pixel[0], pixel[1], pixel[2]};
}

void expect_frame_size(const io::ColorImage& image) {
  EXPECT_EQ(image.width, 2 * kWidth);
  EXPECT_EQ(image.height, 2 * kHeight);
  EXPECT_EQ(image.pixels.size(), 12u * kWidth * kHeight);
}

TEST(ModelThumbnail, ShadesASphereWithoutHoles) {
  constexpr int kPoints = 3000, kSide = 200;
  ObjectModel sphere;
  sphere.diameter = 0.1;
  for (int i = 0; i < kPoints; ++i) {  // a spiral from pole to pole
    const double z = 1 - (2 * i + 1.0) / kPoints, turn = i * M_PI * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3f n(static_cast<float>(r * std::cos(turn)),
                            static_cast<float>(r * std::sin(turn)), static_cast<float>(z));
    sphere.surface.points.push_back(0.05f * n);
    sphere.surface.normals.push_back(n);
  }
  const io::ColorImage picture = model_thumbnail(sphere, kSide);
  ASSERT_EQ(picture.width, kSide);
  ASSERT_EQ(picture.height, kSide);
  const double radius = 0.4 * kSide;  // it fills 80 % of the picture
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      const double off = std::hypot(u + 0.5 - kSide / 2.0, v + 0.5 - kSide / 2.0) / radius;
      const auto color = color_at(picture, u, v);
      if (off > 1.05) {
        EXPECT_EQ(color[0], 255) << u << ' ' << v;
      }
      if (off > 0.93) continue;
      const double facing = std::sqrt(1 - off * off);  // cosine between the normal and the view
      EXPECT_NEAR(color[0], 255 * 0.75 * (0.35 + 0.65 * facing), 8) << u << ' ' << v;
      EXPECT_EQ(color[0], color[2]) << "grey without colours";
    }
  }
}

TEST(DrawEdges, EachKindInItsColour) {
  features::SceneEdges edges{
      {kWidth, kHeight, features::RangeEdge::none}, {kWidth, kHeight, 0}, {kWidth, kHeight, 0}, {}};
  edges.range.at(1, 1) = features::RangeEdge::occluding;
  edges.range.at(2, 1) = features::RangeEdge::occluded;
  edges.curvature.at(3, 1) = 1;
  edges.image.at(4, 1) = 1;
  edges.image.at(1, 1) = 1;  // the range edge comes first
  const io::ColorImage picture = draw::edges(white_frame(), edges);
  expect_frame_size(picture);
  for (const auto& [du, dv] : {std::pair(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
    const auto red = color_at(picture, 2 + du, 2 + dv), blue = color_at(picture, 4 + du, 2 + dv);
    const auto green = color_at(picture, 6 + du, 2 + dv),
               yellow = color_at(picture, 8 + du, 2 + dv);
    EXPECT_TRUE(red[0] > 200 && red[1] < 100 && red[2] < 100);
    EXPECT_TRUE(blue[2] > 200 && blue[0] < 100);
    EXPECT_TRUE(green[1] > 200 && green[0] < 100 && green[2] < 100);
    EXPECT_TRUE(yellow[0] > 200 && yellow[1] > 200 && yellow[2] < 100);
  }
  const auto elsewhere = color_at(picture, 12, 2);
  EXPECT_EQ(elsewhere[0], elsewhere[1]);
  EXPECT_LT(elsewhere[0], 200) << "dimmed";
}

TEST(DrawEdgeImage, WhiteIsOne) {
  Image<float> likelihood(kWidth, kHeight, 0);
  likelihood.at(5, 2) = 1;
  likelihood.at(6, 2) = 0.5f;
  const io::ColorImage picture = edge_image(white_frame(), likelihood);
  expect_frame_size(picture);
  EXPECT_EQ(color_at(picture, 11, 5), (std::array{255, 255, 255}));
  EXPECT_EQ(color_at(picture, 12, 4), (std::array{127, 127, 127}));
  EXPECT_EQ(color_at(picture, 0, 0), (std::array{0, 0, 0}));
}

// Left, right and (the last two columns) nothing; left is red, right green.
segment::Segmentation halves(float affinity) {
  segment::Segmentation out;
  out.labels = Image<std::int32_t>(kWidth, kHeight, -1);
  out.segments.resize(2);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth - 2; ++u) out.labels.at(u, v) = u < 3 ? 0 : 1;
  }
  out.segments[0].mean_color = {53.24f, 80.09f, 67.20f};
  out.segments[1].mean_color = {87.73f, -86.18f, 83.18f};
  out.pairs = {{0, 1, kHeight, 0, 0, affinity}};
  return out;
}

TEST(DrawSegments, BordersTellAffinity) {
  for (const auto& [affinity, grey] : {std::pair(0.9f, 0), std::pair(0.1f, 255)}) {
    Frame frame = white_frame();
    std::fill(frame.color.begin(), frame.color.end(), std::uint8_t{100});
    const io::ColorImage picture = segment_borders(frame, halves(affinity));
    expect_frame_size(picture);
    for (int v = 0; v < 2 * kHeight; ++v) {
      EXPECT_EQ(color_at(picture, 5, v), (std::array{grey, grey, grey}));
      EXPECT_EQ(color_at(picture, 11, v), (std::array{255, 255, 255})) << "the end of the surface";
      EXPECT_EQ(color_at(picture, 3, v), (std::array{100, 100, 100}));
    }
  }
}

TEST(DrawSegments, MeansAreColours) {
  const io::ColorImage picture = segment_means(white_frame(), halves(1));
  expect_frame_size(picture);
  const auto red = color_at(picture, 1, 1), green = color_at(picture, 8, 3);
  EXPECT_TRUE(red[0] > 250 && red[1] < 8 && red[2] < 8);
  EXPECT_TRUE(green[0] < 8 && green[1] > 250 && green[2] < 8);
  EXPECT_EQ(color_at(picture, 14, 3), (std::array{0, 0, 0}));
}

TEST(DrawSegments, MatchesFromRedToGreen) {
  const io::ColorImage picture =
      segment_matches(white_frame(), halves(1), {{0, 5, 0.0, -1}, {1, 5, 1.0, 0}});
  expect_frame_size(picture);
  const auto red = color_at(picture, 1, 1), green = color_at(picture, 8, 3);
  EXPECT_GT(red[0], red[1] + 100);
  EXPECT_GT(green[1], green[0] + 100);
  const auto untouched = color_at(segment_matches(white_frame(), halves(1), {}), 1, 1);
  EXPECT_EQ(untouched[0], untouched[1]);
}

TEST(Draw, NothingKnown) {
  expect_frame_size(edges(white_frame(), {}));
  expect_frame_size(edge_image(white_frame(), {}));
  expect_frame_size(segment_borders(white_frame(), {}));
  expect_frame_size(segment_matches(white_frame(), {}, {}));
  expect_frame_size(segment_means(white_frame(), {}));
}

// A plate of 0.2 m x 0.1 m that faces the camera.
ObjectModel plate() {
  ObjectModel model;
  for (float x = -0.1f; x < 0.1001f; x += 0.0025f) {
    for (float y = -0.05f; y < 0.0501f; y += 0.0025f) model.surface.points.emplace_back(x, y, 0.0f);
  }
  return model;
}

Frame grey_frame() {
  Frame frame;
  frame.camera = {320, 240, 300, 300, 159.5, 119.5};
  frame.depth.assign(320 * 240, 1.0f);
  frame.color.assign(3 * 320 * 240, 100);
  return frame;
}

TEST(Silhouette, OfAPlateIsItsRectangle) {
  const ObjectModel model = plate();
  Pose pose;
  pose.translation = {0.05, -0.02, 0.8};
  const Silhouette shape = silhouette(grey_frame().camera, model.surface, pose);
  int left = 1000, right = -1, top = 1000, bottom = -1, covered = 0;
  for (int v = 0; v < shape.mask.height; ++v) {
    for (int u = 0; u < shape.mask.width; ++u) {
      if (shape.mask.at(u, v) == 0) continue;
      ++covered;
      left = std::min(left, shape.left + u);
      right = std::max(right, shape.left + u);
      top = std::min(top, shape.top + v);
      bottom = std::max(bottom, shape.top + v);
    }
  }
  EXPECT_NEAR(left, 300 * -0.05 / 0.8 + 159.5, 1.5);
  EXPECT_NEAR(right, 300 * 0.15 / 0.8 + 159.5, 1.5);
  EXPECT_NEAR(top, 300 * -0.07 / 0.8 + 119.5, 1.5);
  EXPECT_NEAR(bottom, 300 * 0.03 / 0.8 + 119.5, 1.5);
  EXPECT_GT(covered, 0.9 * (right - left + 1) * (bottom - top + 1));
  pose.translation.z() = -0.8;
  EXPECT_TRUE(silhouette(grey_frame().camera, model.surface, pose).mask.empty());
}

TEST(DrawPoses, OutlinesAndDotsWhereThePosesAre) {
  const ObjectModel model = plate();
  FastPose pose;
  pose.translation = {0.05f, -0.02f, 0.8f};
  // In the enlarged picture, three times the frame.
  const auto at = [](double x, double y) {
    return std::pair(static_cast<int>(std::lround(3 * (300 * x / 0.8 + 160) - 0.5)),
                     static_cast<int>(std::lround(3 * (300 * y / 0.8 + 120) - 0.5)));
  };
  const auto is_green = [](const std::array<int, 3>& c) { return c[1] > c[0] + 60; };
  for (const auto style : {DrawnPoses::Style::dots, DrawnPoses::Style::outlines}) {
    const io::ColorImage picture = poses(grey_frame(), model, {{{&pose, 1}, {0, 255, 0}, style}});
    ASSERT_EQ(picture.width, 960);
    ASSERT_EQ(picture.height, 720);
    int green = 0, near_edge = 0, near_middle = 0;
    const auto [u0, v0] = at(-0.05, -0.07);
    const auto [u1, v1] = at(0.15, 0.03);
    const auto [um, vm] = at(0.05, -0.02);
    for (int v = 0; v < picture.height; ++v) {
      for (int u = 0; u < picture.width; ++u) {
        if (!is_green(color_at(picture, u, v))) continue;
        ++green;
        const int edge =
            std::min({std::abs(u - u0), std::abs(u - u1), std::abs(v - v0), std::abs(v - v1)});
        near_edge += edge <= 4;
        near_middle += std::max(std::abs(u - um), std::abs(v - vm)) <= 3;
      }
    }
    if (style == DrawnPoses::Style::dots) {
      EXPECT_GT(near_middle, 4);
      EXPECT_EQ(near_middle, green);
    } else {
      EXPECT_GT(green, (u1 - u0) + (v1 - v0));  // Half of the border, at least.
      EXPECT_EQ(near_edge, green);
    }
  }
}

TEST(DrawPoses, LaterGroupsCoverEarlierOnesAndTheBestIsBrightest) {
  const ObjectModel model = plate();
  std::vector<FastPose> poses(2);
  poses[0].translation = {-0.1f, 0, 0.8f};
  poses[1].translation = {0.1f, 0, 0.8f};
  const io::ColorImage picture =
      draw::poses(grey_frame(), model,
                  {{poses, {255, 0, 0}, DrawnPoses::Style::dots},
                   {std::span(poses).first(1), {0, 255, 0}, DrawnPoses::Style::dots}});
  const auto first = color_at(picture, 480 - 113, 360), second = color_at(picture, 480 + 112, 360);
  EXPECT_GT(first[1], 200);
  EXPECT_LT(first[0], 60);
  EXPECT_GT(second[0], 120);
  EXPECT_LT(second[0], 230);
}

// Sixty pictures of 964 x 482 in two columns would be 14 580 pixels high.
TEST(ContactSheet, HoldsEveryPictureAndIsNeverTooLargeToWrite) {
  constexpr int kCount = 60;
  std::vector<io::ColorImage> pictures(kCount);
  for (int i = 0; i < kCount; ++i) {
    pictures[i] = {40, 20, std::vector<std::uint8_t>(3 * 40 * 20, static_cast<std::uint8_t>(i))};
  }
  const io::ColorImage sheet = contact_sheet(pictures, 2, 960);
  EXPECT_LE(sheet.width, io::kMaxImageSide);
  EXPECT_LE(sheet.height, io::kMaxImageSide);
  std::array<int, kCount> area{};
  for (std::size_t i = 0; i < sheet.pixels.size(); i += 3) {
    if (sheet.pixels[i] < kCount) ++area[sheet.pixels[i]];
  }
  for (const int pixels : area) EXPECT_EQ(pixels, area[0]);
  EXPECT_GT(area[0], 300 * 150);
}

TEST(ContactSheet, ThatFitsHasTheColumnsAndSizesAskedFor) {
  const std::vector<io::ColorImage> pictures(3, {40, 20, std::vector<std::uint8_t>(2400, 7)});
  const io::ColorImage sheet = contact_sheet(pictures, 2, 100);
  EXPECT_EQ(sheet.width, 2 * 104);
  EXPECT_EQ(sheet.height, 2 * 54);
}

}  // namespace
}  // namespace bpa::draw
