// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/rival_poses.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

constexpr int kSize = 40;

// All pixels see the same depth; 0 is none.
CheckImage image_at(float depth) {
  CheckImage out;
  out.width = out.height = kSize;
  out.fx = out.fy = 260;
  out.cx = out.cy = 20;
  out.pixels.resize(kSize * kSize);
  for (CheckPixel& pixel : out.pixels) pixel.depth = depth;
  return out;
}

// A rectangle of 10 rows and `width` columns, at `depth` metres.
PredictedSurface rectangle_at(int u, int v, int width, float depth) {
  return {u, v, Image<float>(width, 10, depth), Image<std::uint32_t>(width, 10, 0u)};
}

// A square of 10 x 10 pixels at 0.8 m.
PredictedSurface square_at(int u, int v) { return rectangle_at(u, v, 10, 0.8f); }

// The standard deviation of a Kinect's depth at 0.8 m, in metres (Nguyen, Izadi and Lovell, 3DIMPVT
// 2012).
constexpr double kKinectSigma = 0.0012 + 0.0019 * (0.8 - 0.4) * (0.8 - 0.4);

double rival_evidence(const CheckImage& image, const PredictedSurface& first,
                      const PredictedSurface& second) {
  return depth_evidence(image, first, second, disagreement(image, first, second));
}

double against_nothing(float observed) {
  return rival_evidence(image_at(observed), square_at(10, 10), {});
}

TEST(RivalEvidence, SurfaceIsEvidenceForAndFreeSpaceAgainstAndWhatIsHiddenSaysLittle) {
  EXPECT_GT(against_nothing(0.8f), 200);   // 100 pixels, on average over e^2 times as likely
  EXPECT_LT(against_nothing(1.2f), -100);  // on average under 1/e as likely
  EXPECT_LE(against_nothing(0.5f), 0);
  EXPECT_GT(against_nothing(0.5f), -20);
  EXPECT_EQ(against_nothing(0), 0) << "no depth, no evidence";
}

TEST(RivalEvidence, FallsWithTheDistanceFromTheSurface) {
  for (const float side : {-1.0f, 1.0f}) {
    double nearer = against_nothing(0.8f);
    for (int mm = 2; mm <= 14; mm += 2) {
      const double farther = against_nothing(0.8f + side * 0.001f * static_cast<float>(mm));
      EXPECT_LT(farther, nearer) << side * static_cast<float>(mm) << " mm";
      nearer = farther;
    }
  }
  // The sensor's noise alone keeps most of the evidence; ten times as much leaves none.
  EXPECT_GT(against_nothing(static_cast<float>(0.8 + kKinectSigma)), 0.9 * against_nothing(0.8f));
  EXPECT_LT(against_nothing(static_cast<float>(0.8 + 15 * kKinectSigma)), 0);
}

// Pixels are independent: ten more columns add the same, however many there are.
TEST(RivalEvidence, IsASumOverPixels) {
  for (const float observed : {0.8f, 0.81f, 0.5f, 1.2f}) {
    const auto of_width = [&](int width) {
      return rival_evidence(image_at(observed), rectangle_at(4, 10, width, 0.8f), {});
    };
    EXPECT_NEAR(of_width(30) - of_width(20), of_width(20) - of_width(10), 1e-3) << observed;
  }
}

// Depths drawn with a Kinect's noise speak for the surface that they were drawn from.
TEST(RivalEvidence, NoisyDepthsTellTheirSurfaceFromOneThreeCentimetresAway) {
  RandomStream random(5);
  for (int repeat = 0; repeat < 20; ++repeat) {
    CheckImage image = image_at(0.8f);
    for (CheckPixel& pixel : image.pixels) {
      pixel.depth += static_cast<float>(kKinectSigma * random.normal());
    }
    for (const float offset : {-0.03f, 0.03f}) {
      const PredictedSurface wrong = rectangle_at(10, 10, 10, 0.8f + offset);
      EXPECT_GT(rival_evidence(image, square_at(10, 10), wrong), 100);
    }
  }
}

TEST(RivalEvidence, OnlyWhatPosesDisagreeAboutCounts) {
  const CheckImage image = image_at(0.8f);
  EXPECT_EQ(rival_evidence(image, square_at(10, 10), square_at(11, 10)), 0);
  EXPECT_EQ(rival_evidence(image, square_at(10, 10), square_at(12, 12)), 0);
  EXPECT_EQ(rival_evidence(image, {}, {}), 0);
  // Three pixels beside: of both, a column of ten pixels is more than 6 mm, two pixels, away.
  EXPECT_NEAR(rival_evidence(image, square_at(10, 10), square_at(13, 10)), 0, 1e-3);
  CheckImage left = image;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 20; u < kSize; ++u) left.pixels[static_cast<std::size_t>(v * kSize + u)].depth = 2;
  }
  EXPECT_GT(rival_evidence(left, square_at(10, 10), square_at(13, 10)), 20);
}

class BehindBest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Pose camera_from_world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
    model_ = test::l_model();
    truth_ = camera_from_world * test::standing_at(0, 0, 0.02, 0.7);
    const auto seen =
        test::render(test::together({test::table(camera_from_world)}, test::l_solids(truth_)),
                     test::kinect_camera(), 1, 8);
    image_ = scene_.image = make_check_image(surface_map(seen.frame, {}));
  }
  Pose turned(double angle) const {
    return truth_ * Pose{rotation_from_vector(angle * Eigen::Vector3d::UnitZ()), {0, 0, 0}};
  }

  SceneFeatures scene_;
  std::shared_ptr<const ObjectModel> model_;
  Pose truth_;
  CheckImage image_;
};

TEST_F(BehindBest, TurnedPosesAreBehindTheTrueOneWhicheverIsFirst) {
  const Pose near = test::disturbed(truth_, 0.002, 0.02, 3);
  for (const Pose& first : {near, turned(M_PI)}) {
    const std::vector<Pose> poses = {first, turned(1.5), near, turned(-1.5), turned(M_PI)};
    const auto behind = behind_best(scene_, *model_, poses, poses.size());
    ASSERT_EQ(behind.size(), poses.size());
    EXPECT_EQ(behind[2].depth, 0);
    for (std::size_t turned : {1, 3, 4}) EXPECT_LT(behind[turned].depth, -30);
  }
}

TEST_F(BehindBest, WhatDoesNotContendMakesNothingLessLikely) {
  const std::vector<Pose> poses = {turned(1.5), turned(M_PI), truth_};
  const auto all = behind_best(scene_, *model_, poses, 3);
  EXPECT_LT(all[0].depth, -30);
  const auto one = behind_best(scene_, *model_, poses, 1);
  EXPECT_EQ(one[0].depth, 0);
  EXPECT_EQ(one[2].depth, 0) << "better than the best contender, clamped";
  EXPECT_NEAR(one[1].depth, std::min(0.0, all[1].depth - all[0].depth), 1e-6);
}

TEST_F(BehindBest, NothingIsBehindItself) {
  const auto alone = behind_best(scene_, *model_, std::vector<Pose>{turned(1)}, 1);
  ASSERT_EQ(alone.size(), 1u);
  EXPECT_EQ(alone[0].depth, 0);
  EXPECT_EQ(alone[0].color, 0);
  EXPECT_TRUE(behind_best(scene_, *model_, {}, 0).empty());
}

TEST_F(BehindBest, EvidenceForTheOneIsEvidenceAgainstTheOther) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto drawn = [&](std::uint64_t s) {
      return predict_whole_surface(image_, *model_, test::disturbed(truth_, 0.02, 0.5, s));
    };
    const PredictedSurface a = drawn(seed), b = drawn(seed + 100);
    EXPECT_NEAR(rival_evidence(image_, a, b), -rival_evidence(image_, b, a), 1e-3);
  }
}

}  // namespace
}  // namespace bpa::score
