// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/pose_check.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/model/model_index.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

using test::Solid;

constexpr int kAll = 1024;

class PoseCheckOfAnL : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { model_ = test::l_model(); }
  static void TearDownTestSuite() { model_.reset(); }

  static CheckImage image_of(const std::vector<Solid>& solids) {
    const auto image = test::render(solids, test::kinect_camera());
    return make_check_image(surface_map(image.frame, {}));
  }
  static PoseCheck check(const CheckImage& image, const Pose& pose, int count = kAll) {
    return check_pose(image, model_->index->check, to_fast(pose), {count}, {0.010, 0.030, 0.75});
  }
  static std::vector<Solid> scene() {
    return test::together({test::table(camera_from_world_)}, test::l_solids(truth_));
  }

  static inline std::shared_ptr<const ObjectModel> model_;
  static inline const Pose camera_from_world_ = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  static inline const Pose truth_ = camera_from_world_ * test::standing_at(0, 0, 0.02, 0.7);
};

TEST_F(PoseCheckOfAnL, TruthAgreesAndHangsNowhere) {
  const PoseCheck found = check(image_of(scene()), truth_);
  EXPECT_GT(found.facing, 250);
  EXPECT_GT(found.seen, found.facing * 8 / 10);
  EXPECT_GT(found.agreeing, found.seen * 85 / 100);
  EXPECT_LT(found.free_space, 5) << "but for the outline";
  EXPECT_GT(found.score(), 1.0f);
}

TEST_F(PoseCheckOfAnL, TruthScoresHigherThanWhatIsBesideIt) {
  const CheckImage image = image_of(scene());
  const float best = check(image, truth_).score();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    EXPECT_LT(check(image, test::disturbed(truth_, 0.04, 0, seed)).score(), best - 0.05f);
    EXPECT_LT(check(image, test::disturbed(truth_, 0, 0.5, seed)).score(), best - 0.05f);
    EXPECT_LT(check(image, test::disturbed(truth_, 0.15, 1.5, seed)).score(), best - 0.3f);
  }
}

TEST_F(PoseCheckOfAnL, WhatHidesItDoesNotCountAgainstIt) {
  const PoseCheck open = check(image_of(scene()), truth_);
  // A board between camera and object that covers the right part of the image.
  const Eigen::Vector3d middle = truth_ * Eigen::Vector3d(0, 0, 0.02);
  const Solid board{Solid::Kind::box,
                    {0.5, 0.5, 0.005},
                    {Eigen::Quaterniond::Identity(), 0.6 * middle + Eigen::Vector3d(0.5, 0, 0)}};
  const PoseCheck hidden = check(image_of(test::together(scene(), {board})), truth_);
  EXPECT_EQ(hidden.facing, open.facing);
  EXPECT_LT(hidden.seen, open.seen * 3 / 4);
  EXPECT_GT(hidden.seen, open.seen / 5);
  EXPECT_LT(hidden.free_space, 5);
  EXPECT_GT(hidden.agreeing, hidden.seen * 8 / 10);
  EXPECT_LT(hidden.score(), open.score()) << "there is less to be sure of";
}

TEST_F(PoseCheckOfAnL, HangingInFreeSpaceCountsAgainstIt) {
  const CheckImage image = image_of({test::table(camera_from_world_)});
  const Pose above = camera_from_world_ * test::standing_at(0, 0, 0.2, 0.7);
  const PoseCheck found = check(image, above, kAll);
  EXPECT_GT(found.free_space, found.seen * 9 / 10);
  EXPECT_EQ(found.agreeing, 0);
  EXPECT_LT(found.score(), 0);
}

TEST_F(PoseCheckOfAnL, BackgroundDoesNotAgree) {
  CheckImage image = image_of(scene());
  for (CheckPixel& pixel : image.pixels) pixel.searched = 0;
  EXPECT_EQ(check(image, truth_).agreeing, 0);
}

TEST_F(PoseCheckOfAnL, NormalsMustAgree) {
  CheckImage image = image_of(scene());
  for (CheckPixel& pixel : image.pixels) {
    for (std::int8_t& n : pixel.normal) n = static_cast<std::int8_t>(-n);
  }
  EXPECT_EQ(check(image, truth_).agreeing, 0);
}

TEST_F(PoseCheckOfAnL, OutOfViewNothingFaces) {
  const CheckImage image = image_of(scene());
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5, 0, 1),
        Eigen::Vector3d(0, -9, 2), Eigen::Vector3d(0, 0, 0.05)}) {
    const PoseCheck found = check(image, {truth_.rotation, place});
    EXPECT_LT(found.facing, 25) << place.transpose();
    EXPECT_TRUE(std::isfinite(found.score()));
  }
}

TEST_F(PoseCheckOfAnL, LooksAtNoMorePointsThanAsked) {
  const CheckImage image = image_of(scene());
  const PoseCheck some = check(image, truth_, 64);
  EXPECT_LE(some.facing, 64);
  EXPECT_GT(some.facing, 10);
  EXPECT_EQ(check(image, truth_, 0).facing, 0);
  EXPECT_EQ(check(image, truth_, kAll * 10).facing, check(image, truth_, kAll).facing);
}

TEST(CheckImage, PacksTheMap) {
  const Pose camera_from_world = test::look_at({0, -0.6, 0.5}, {0, 0, 0});
  const auto image = test::render({test::table(camera_from_world)}, test::kinect_camera());
  SurfaceMap map = surface_map(image.frame, {});
  map.searched[7] = 0;
  const CheckImage packed = make_check_image(map);
  ASSERT_EQ(packed.pixels.size(), map.size());
  EXPECT_EQ(packed.width, 320);
  EXPECT_EQ(packed.height, 240);
  EXPECT_FLOAT_EQ(packed.fx, 262.5f);
  for (std::size_t i = 0; i < map.size(); i += 91) {
    EXPECT_EQ(packed.pixels[i].depth, map.depth[i]);
    EXPECT_EQ(packed.pixels[i].searched, map.searched[i]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(packed.pixels[i].normal[k] / 127.0, map.normals[i][k], 0.004);
    }
  }
}

}  // namespace
}  // namespace bpa::score
