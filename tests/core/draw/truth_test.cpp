// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/draw/annotate.hpp"

namespace bpa::draw {
namespace {

/// A library of one model, number 1: a plate of 0.2 m x 0.1 m.
ModelLibrary plates() {
  auto plate = std::make_shared<ObjectModel>();
  plate->name = "plate";
  plate->number = 1;
  for (float x = -0.1f; x < 0.1001f; x += 0.005f) {
    for (float y = -0.05f; y < 0.0501f; y += 0.005f) plate->surface.points.emplace_back(x, y, 0.0f);
  }
  ModelLibrary library;
  EXPECT_TRUE(library.add(plate).ok());
  return library;
}

Pose at(double x) { return {Eigen::Quaterniond::Identity(), {x, 0, 1}}; }

io::BopInstance instance(double x, double visible) {
  io::BopInstance truth;
  truth.obj_id = 1;
  truth.camera_from_object = at(x);
  truth.visible_fraction = visible;
  return truth;
}

Placement placement(double x, double probability) {
  Placement out;
  out.model = "plate";
  out.model_number = 1;
  out.frame_from_object = at(x);
  out.probability = probability;
  return out;
}

Frame empty_frame() {
  Frame frame;
  frame.camera = {320, 240, 300, 300, 159.5, 119.5};
  frame.depth.assign(320 * 240, 1.0f);
  frame.color.assign(3 * 320 * 240, 100);
  return frame;
}

/// Red pixels of the left and the right half of a picture.
std::pair<int, int> red_pixels(const io::ColorImage& picture) {
  std::pair<int, int> count;
  for (int i = 0; i < picture.width * picture.height; ++i) {
    const std::uint8_t* p = picture.pixels.data() + 3 * i;
    if (p[0] > 200 && p[1] < 90 && p[2] < 90) {
      ++(i % picture.width < picture.width / 2 ? count.first : count.second);
    }
  }
  return count;
}

TEST(TruthBesideResult, CountsFoundMissedAndFalse) {
  // Found by the second placement (2 cm off), missed, and too hidden to count.
  const std::vector<io::BopInstance> truth = {instance(-0.2, 1), instance(0.2, 0.5),
                                              instance(0, 0.05)};
  Interpretation result;
  result.placements = {placement(0.1, 0.9), placement(-0.18, 0.8)};
  const JudgedFrame judged =
      truth_beside_result(empty_frame(), truth, result, plates(), "scene 1 image 2");
  EXPECT_EQ(judged.found, 1);
  EXPECT_EQ(judged.missed, 1);
  EXPECT_EQ(judged.wrong, 1);
  EXPECT_EQ(judged.picture.width, 2 * 320);
  EXPECT_GT(judged.picture.height, 240) << "room for words";
  const auto [left, right] = red_pixels(judged.picture);
  EXPECT_GT(left, 100) << "MISSED";
  EXPECT_GT(right, 100) << "FALSE";
}

TEST(TruthBesideResult, IsNotRedWhereAllIsRight) {
  Interpretation result;
  result.placements = {placement(0, 0.9)};
  const JudgedFrame judged =
      truth_beside_result(empty_frame(), {instance(0, 1)}, result, plates(), "");
  EXPECT_EQ(judged.found, 1);
  EXPECT_EQ(judged.missed + judged.wrong, 0);
  EXPECT_EQ(red_pixels(judged.picture), (std::pair{0, 0}));
}

TEST(WorstFirst, ByErrorsThenByOrder) {
  std::vector<JudgedFrame> frames(4);
  frames[1].missed = 1;
  frames[2].missed = frames[2].wrong = 1;
  frames[3].wrong = 1;
  EXPECT_EQ(worst_first(frames), (std::vector<std::size_t>{2, 1, 3, 0}));
}

}  // namespace
}  // namespace bpa::draw
