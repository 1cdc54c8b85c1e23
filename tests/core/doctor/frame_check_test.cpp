// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Good frames give no finding. Each fault, put into a good frame, gives its own and no other.
#include "core/doctor/frame_check.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/io/bop_dataset.hpp"
#include "core/sim/scenes.hpp"
#include "tests/core/doctor/findings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::doctor {
namespace {

using test::Whats;
using test::whats;

constexpr double kRange_m = 2.5;

/// A simulated pile; the simulated sensor's colour is that many pixels off its depth.
Frame pile(double misregistration) {
  static const sim::Stage stage(
      sim::household_objects({"mug", "milk_carton", "can", "gear", "cereal_box", "l_brick"}));
  sim::SceneOptions options;
  options.min_objects = 5;
  options.max_objects = 6;
  options.empty_share = options.distractor_share = options.border_share = 0;
  options.sensor.color.misregistration = misregistration;
  return sim::simulate_scene(stage, options, 4).frames.front().frame;
}

const Frame& good() {
  static const Frame frame = pile(0);
  return frame;
}

Whats found(const Frame& frame) { return whats(check_frame(frame, kRange_m)); }

Frame with_depth(const std::function<float(float)>& change) {
  Frame frame = good();
  for (float& z : frame.depth) z = change(z);
  return frame;
}

Frame with_color(const std::function<double(double)>& change) {
  Frame frame = good();
  for (std::uint8_t& c : frame.color) {
    c = static_cast<std::uint8_t>(std::clamp(change(c), 0.0, 255.0));
  }
  return frame;
}

/// Depth that comes from (right, down) pixels away.
Frame moved(const Frame& frame, int right, int down) {
  Frame out = frame;
  const int width = frame.camera.width, height = frame.camera.height;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int from_u = u - right, from_v = v - down;
      const bool inside = from_u >= 0 && from_v >= 0 && from_u < width && from_v < height;
      out.depth[v * width + u] = inside ? frame.depth[from_v * width + from_u] : 0;
    }
  }
  return out;
}

TEST(CheckFrame, SaysNothingOfASimulatedFrame) { EXPECT_EQ(found(good()), Whats{}); }

TEST(CheckFrame, SaysNothingOfAFrameWithoutColour) {
  Frame frame = good();
  frame.color.clear();
  EXPECT_EQ(found(frame), Whats{});
}

std::vector<Frame> real_frames() {
  std::vector<Frame> frames;
  const auto entries = io::read_bop_frames(test::real_data() + "/ycbv", "test");
  EXPECT_TRUE(entries.ok());
  for (const io::BopFrame& entry : *entries) {
    auto frame = io::load_bop_frame(entry);
    EXPECT_TRUE(frame.ok());
    frames.push_back(*frame);
  }
  return frames;
}

TEST(CheckFrame, SaysNothingOfRealFrames) {
  if (test::real_data().empty()) GTEST_SKIP() << "no real frames";
  for (const Frame& frame : real_frames()) EXPECT_EQ(found(frame), Whats{}) << frame.frame_id;
}

TEST(CheckFrame, MeasuresHowFarDepthIsFromColour) {
  const auto now = find_edge_offset(good());
  ASSERT_TRUE(now.has_value());
  EXPECT_LE(now->pixels, 2.01);  // the resolution of the surface map
  const auto offset = find_edge_offset(moved(good(), 18, -10));
  ASSERT_TRUE(offset.has_value());
  EXPECT_NEAR(offset->right, -18, 2);
  EXPECT_NEAR(offset->down, 10, 2);
  EXPECT_EQ(offset->scale, 1);
  EXPECT_NEAR(offset->pixels, std::hypot(18, 10), 3);
}

TEST(CheckFrame, DepthThatIsNotRegistered) {
  EXPECT_EQ(found(moved(good(), 18, -10)), Whats{"depth is not registered to colour"});
  EXPECT_EQ(found(pile(16)), Whats{"depth is not registered to colour"});
}

TEST(CheckFrame, RealDepthThatIsNotRegistered) {
  if (test::real_data().empty()) GTEST_SKIP() << "no real frames";
  int said = 0;
  const auto frames = real_frames();
  for (const Frame& frame : frames) {
    said += found(moved(frame, 14, 6)) == Whats{"depth is not registered to colour"};
  }
  EXPECT_GE(said, 6) << "of " << frames.size();  // one has more clutter than edges
}

/// 16 bits as a program wrote them that does not turn them over for PNG.
TEST(CheckFrame, DepthWithSwappedBytes) {
  for (const double unit_mm : {1.0, 0.2, 0.1}) {
    const auto stored = [&](float z) {
      return static_cast<std::uint16_t>(std::lround(1000 * static_cast<double>(z) / unit_mm));
    };
    const auto metres = [&](std::uint16_t u) { return static_cast<float>(0.001 * unit_mm * u); };
    EXPECT_EQ(found(with_depth([&](float z) { return metres(stored(z)); })), Whats{}) << unit_mm;
    Frame frame = with_depth([&](float z) { return metres(__builtin_bswap16(stored(z))); });
    EXPECT_EQ(found(frame), Whats{"depth has the bytes of its numbers swapped"}) << unit_mm;
    clean_depth(frame);  // as a search has it
    EXPECT_EQ(found(frame), Whats{"depth has the bytes of its numbers swapped"}) << unit_mm;
  }
}

TEST(CheckFrame, WhatCannotBeSearchedIsSaidByItsCause) {
  Frame centimetres = with_depth([](float z) { return 100 * z; });
  const Frame before = centimetres;
  const Status status = make_searchable(centimetres, kRange_m);
  EXPECT_NE(status.message.find("smaller units are taken for metres. Correct the scale: of clouds "
                                "--unit"),
            std::string::npos)
      << status.message;
  Frame fine = good();
  EXPECT_TRUE(make_searchable(fine, kRange_m).ok());
}

TEST(CheckFrame, DepthInAnotherUnit) {
  for (const float scale : {1e3f, 1e2f, 1e-3f}) {
    EXPECT_EQ(found(with_depth([=](float z) { return scale * z; })),
              Whats{"depth is in the wrong unit"})
        << scale;
  }
}

TEST(CheckFrame, ScenesTooFarAndTooNear) {
  EXPECT_EQ(found(with_depth([](float z) { return 4 * z; })), Whats{"the scene is too far away"});
  EXPECT_EQ(found(with_depth([](float z) { return 0.1f * z; })), Whats{"the scene is too near"});
}

TEST(CheckFrame, DepthWithHoles) {
  int i = 0;
  EXPECT_EQ(found(with_depth([&](float z) { return ++i % 640 < 224 ? z : 0; })),
            Whats{"depth has large holes"});
  EXPECT_EQ(found(with_depth([](float) { return std::nanf(""); })),
            Whats{"the frame cannot be searched"});
}

TEST(CheckFrame, ColourTooDarkTooBrightAndClipped) {
  EXPECT_EQ(found(with_color([](double c) { return 0.1 * c; })), Whats{"colour is too dark"});
  EXPECT_EQ(found(with_color([](double c) { return 238 + 0.05 * c; })),
            Whats{"colour is too bright"});
  EXPECT_EQ(found(with_color([](double c) { return c > 40 ? 255 : c; })),
            Whats{"colour is too bright"});
}

TEST(CheckFrame, GreyColour) {
  Frame frame = good();
  for (std::size_t i = 0; i < frame.color.size(); i += 3) {
    frame.color[i] = frame.color[i + 2] = frame.color[i + 1];
  }
  EXPECT_EQ(found(frame), Whats{"colour has no hues"});
}

TEST(CheckFrame, IntrinsicsThatDoNotFit) {
  Frame frame = good();
  const Camera right = frame.camera;
  for (const double factor : {0.3, 3.0}) {
    frame.camera.fx = factor * right.fx;
    frame.camera.fy = factor * right.fy;
    EXPECT_EQ(found(frame), Whats{"the focal length does not fit the image"}) << factor;
  }
  frame.camera = right;
  frame.camera.fy *= 1.2;
  EXPECT_EQ(found(frame), Whats{"the focal lengths differ"});
  frame.camera = right;
  frame.camera.cx = 639.5;  // of an image twice as wide
  EXPECT_EQ(found(frame), Whats{"the principal point is far from the centre"});
  frame.camera = right;
  frame.camera.fx = -1;
  EXPECT_EQ(found(frame), Whats{"the camera cannot be used"});
}

TEST(CheckFrame, ImagesOfDifferentSizes) {
  Frame frame = good();
  frame.color.resize(frame.color.size() / 4);
  EXPECT_EQ(found(frame), Whats{"the frame cannot be searched"});
}

}  // namespace
}  // namespace bpa::doctor
