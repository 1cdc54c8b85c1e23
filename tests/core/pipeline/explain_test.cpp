// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bpa/core/pipeline/explain.hpp>

namespace bpa {
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

TEST(DrawEdges, EachKindInItsColour) {
  SceneEdges edges{
      {kWidth, kHeight, RangeEdge::none}, {kWidth, kHeight, 0}, {kWidth, kHeight, 0}, {}};
  edges.range.at(1, 1) = RangeEdge::occluding;
  edges.range.at(2, 1) = RangeEdge::occluded;
  edges.curvature.at(3, 1) = 1;
  edges.image.at(4, 1) = 1;
  edges.image.at(1, 1) = 1;  // the range edge comes first
  const io::ColorImage picture = draw_edges(white_frame(), edges);
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
  const io::ColorImage picture = draw_edge_image(white_frame(), likelihood);
  expect_frame_size(picture);
  EXPECT_EQ(color_at(picture, 11, 5), (std::array{255, 255, 255}));
  EXPECT_EQ(color_at(picture, 12, 4), (std::array{127, 127, 127}));
  EXPECT_EQ(color_at(picture, 0, 0), (std::array{0, 0, 0}));
}

// Left, right and (the last two columns) nothing; left is red, right green.
Segmentation halves(float affinity) {
  Segmentation out;
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
    const io::ColorImage picture = draw_segment_borders(frame, halves(affinity));
    expect_frame_size(picture);
    for (int v = 0; v < 2 * kHeight; ++v) {
      EXPECT_EQ(color_at(picture, 5, v), (std::array{grey, grey, grey}));
      EXPECT_EQ(color_at(picture, 11, v), (std::array{255, 255, 255})) << "the end of the surface";
      EXPECT_EQ(color_at(picture, 3, v), (std::array{100, 100, 100}));
    }
  }
}

TEST(DrawSegments, MeansAreColours) {
  const io::ColorImage picture = draw_segment_means(white_frame(), halves(1));
  expect_frame_size(picture);
  const auto red = color_at(picture, 1, 1), green = color_at(picture, 8, 3);
  EXPECT_TRUE(red[0] > 250 && red[1] < 8 && red[2] < 8);
  EXPECT_TRUE(green[0] < 8 && green[1] > 250 && green[2] < 8);
  EXPECT_EQ(color_at(picture, 14, 3), (std::array{0, 0, 0}));
}

TEST(DrawSegments, MatchesFromRedToGreen) {
  const io::ColorImage picture =
      draw_segment_matches(white_frame(), halves(1), {{0, 5, 0.0, -1}, {1, 5, 1.0, 0}});
  expect_frame_size(picture);
  const auto red = color_at(picture, 1, 1), green = color_at(picture, 8, 3);
  EXPECT_GT(red[0], red[1] + 100);
  EXPECT_GT(green[1], green[0] + 100);
  const auto untouched = color_at(draw_segment_matches(white_frame(), halves(1), {}), 1, 1);
  EXPECT_EQ(untouched[0], untouched[1]);
}

TEST(Draw, NothingKnown) {
  expect_frame_size(draw_edges(white_frame(), {}));
  expect_frame_size(draw_edge_image(white_frame(), {}));
  expect_frame_size(draw_segment_borders(white_frame(), {}));
  expect_frame_size(draw_segment_matches(white_frame(), {}, {}));
  expect_frame_size(draw_segment_means(white_frame(), {}));
}

}  // namespace
}  // namespace bpa
