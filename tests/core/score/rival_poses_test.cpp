// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/rival_poses.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/posed_models.hpp"

namespace bpa {
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

// A square of 10 x 10 pixels at 0.8 m.
PredictedSurface square_at(int u, int v) {
  return {u, v, Image<float>(10, 10, 0.8f), Image<std::uint32_t>(10, 10, 0u)};
}

TEST(RivalEvidence, AgainstNothingEachPixelCountsItsLogLikelihoodRatio) {
  // Seen: 0.7 of a normal density of 1.5 times the noise of sensor and model against one of 1 per
  // metre; of a pixel on the rim a half may show what is behind.
  const double noise = 0.0012 + 0.0019 * 0.4 * 0.4;
  const double sigma = 1.5 * std::hypot(noise, 0.003);
  const double peak = 0.7 / (std::sqrt(2 * M_PI) * sigma);
  const double fit =
      64 * std::log(0.95 * (peak + 0.02) + 0.05) + 36 * std::log(0.5 * (peak + 1.02));
  EXPECT_NEAR(rival_evidence(image_at(0.8f), square_at(10, 10), {}), fit, 0.01);
  const double through = 64 * std::log(0.95 * 0.02 + 0.05) + 36 * std::log(0.5 * 1.02);
  EXPECT_NEAR(rival_evidence(image_at(1.2f), square_at(10, 10), {}), through, 0.01);
  const double hidden = 64 * std::log(0.95 * 0.9 + 0.05) + 36 * std::log(0.5 * 1.9);
  EXPECT_NEAR(rival_evidence(image_at(0.5f), square_at(10, 10), {}), hidden, 0.01);
  EXPECT_EQ(rival_evidence(image_at(0), square_at(10, 10), {}), 0);
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
    image_ = make_check_image(surface_map(seen.frame, {}));
  }
  Pose turned(double angle) const {
    return truth_ * Pose{rotation_from_vector(angle * Eigen::Vector3d::UnitZ()), {0, 0, 0}};
  }

  std::shared_ptr<const ObjectModel> model_;
  Pose truth_;
  CheckImage image_;
};

TEST_F(BehindBest, TurnedPosesAreBehindTheTrueOneWhicheverIsFirst) {
  const Pose near = test::disturbed(truth_, 0.002, 0.02, 3);
  for (const Pose& first : {near, turned(M_PI)}) {
    const std::vector<Pose> poses = {first, turned(1.5), near, turned(-1.5), turned(M_PI)};
    const std::vector<double> behind = behind_best(image_, *model_, poses);
    ASSERT_EQ(behind.size(), poses.size());
    EXPECT_EQ(behind[2], 0);
    for (std::size_t turned : {1, 3, 4}) EXPECT_LT(behind[turned], -30);
  }
}

TEST_F(BehindBest, NothingIsBehindItself) {
  EXPECT_EQ(behind_best(image_, *model_, std::vector<Pose>{turned(1)}), std::vector<double>{0});
  EXPECT_TRUE(behind_best(image_, *model_, {}).empty());
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
}  // namespace bpa
