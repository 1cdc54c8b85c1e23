// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/frame.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace bpa {
namespace {

constexpr std::size_t kPixels = 40 * 30;

Frame good_frame() {
  Frame frame;
  frame.camera = {40, 30, 35, 35, 19.5, 14.5};
  frame.depth.assign(kPixels, 1.0f);
  return frame;
}

std::string message(const Frame& frame) {
  const Status status = validate(frame);
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  return status.message;
}

TEST(Frame, TakesDepthAlone) { EXPECT_TRUE(validate(good_frame()).ok()); }

TEST(Frame, TakesEverythingTogether) {
  Frame frame = good_frame();
  frame.color.assign(3 * kPixels, 7);
  frame.mask.assign(kPixels, 1);
  frame.background.assign(kPixels, 0);
  frame.roi = {0, 0, 40, 30};
  EXPECT_TRUE(validate(frame).ok());
}

TEST(Frame, NamesTheArrayOfTheWrongSize) {
  Frame frame = good_frame();
  frame.depth.resize(kPixels - 1);
  EXPECT_EQ(message(frame),
            "frame depth has 1199 values; it must have 1200 (width x height of the camera)");
  frame = good_frame();
  frame.color.assign(kPixels, 0);
  EXPECT_EQ(message(frame),
            "frame color has 1200 values; it must have 3600 (3 x width x height of the camera)");
  frame = good_frame();
  frame.mask.assign(1, 1);
  EXPECT_EQ(message(frame),
            "frame mask has 1 values; it must have 1200 (width x height of the camera)");
  frame = good_frame();
  frame.background.assign(kPixels + 1, 1);
  EXPECT_EQ(message(frame),
            "frame background has 1201 values; it must have 1200 (width x height of the camera)");
}

TEST(Frame, ChecksTheCameraFirst) {
  Frame frame = good_frame();
  frame.camera.fx = -1;
  frame.depth.clear();
  EXPECT_NE(message(frame).find("camera fx"), std::string::npos);
  EXPECT_FALSE(validate(Frame{}).ok());
}

TEST(Frame, RegionOfInterestMustLieInside) {
  constexpr int kHuge = std::numeric_limits<int>::max();
  const RegionOfInterest outside[] = {{-1, 0, 5, 5},    {0, -1, 5, 5},    {36, 0, 5, 5},
                                      {0, 26, 5, 5},    {0, 0, 41, 30},   {kHuge, 0, 1, 1},
                                      {1, 1, kHuge, 1}, {1, 1, 1, kHuge}, {kHuge, kHuge, kHuge, 1}};
  for (const RegionOfInterest& roi : outside) {
    Frame frame = good_frame();
    frame.roi = roi;
    EXPECT_NE(message(frame).find("leaves the image of 40x30; it must lie inside"),
              std::string::npos);
  }
  for (const RegionOfInterest& roi : {RegionOfInterest{35, 25, 5, 5}, RegionOfInterest{0, 0, 1, 1},
                                      RegionOfInterest{-3, 99, 0, 5}}) {
    Frame frame = good_frame();
    frame.roi = roi;
    EXPECT_TRUE(validate(frame).ok()) << "empty means the whole image";
  }
}

TEST(Frame, FiveHundredValidPixelsAreEnough) {
  Frame frame = good_frame();
  const float invalid[] = {0, -1, std::nanf(""), std::numeric_limits<float>::infinity(), 20.01f};
  for (std::size_t i = 500; i < kPixels; ++i) frame.depth[i] = invalid[i % 5];
  frame.depth[0] = 20.0f;
  frame.depth[1] = 1e-3f;
  EXPECT_TRUE(validate(frame).ok());
  frame.depth[2] = 0;
  EXPECT_EQ(message(frame),
            "frame depth has 499 valid pixels; it must have at least 500 with a depth in (0, 20] "
            "m (0 and NaN mean no depth)");
}

TEST(Frame, CleaningLeavesZeroForWhateverIsNoDepth) {
  Frame frame = good_frame();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  frame.depth = {std::nanf(""), kInfinity, -kInfinity, -0.5f, 0, 20.001f, 20, 0.3f};
  clean_depth(frame);
  EXPECT_EQ(frame.depth, (std::vector<float>{0, 0, 0, 0, 0, 0, 20, 0.3f}));
}

TEST(Crop, SeesTheSameInItsPart) {
  Frame frame = good_frame();
  frame.color.assign(3 * kPixels, 0);
  frame.depth[12 * 40 + 17] = 0.5f;
  frame.color[3 * (12 * 40 + 17) + 1] = 7;
  const Frame part = crop(frame, {16, 10, 8, 6});
  EXPECT_EQ(part.camera.width, 8);
  EXPECT_EQ(part.camera.height, 6);
  ASSERT_EQ(part.depth.size(), 8u * 6);
  EXPECT_EQ(part.depth[2 * 8 + 1], 0.5f);
  EXPECT_EQ(part.color[3 * (2 * 8 + 1) + 1], 7);
  EXPECT_EQ(part.camera.unproject(1, 2, 0.5), frame.camera.unproject(17, 12, 0.5));
}

}  // namespace
}  // namespace bpa
