// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/resting_score.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

// A brick on a table that the camera looks at from above at a slant.
class RestingScore : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_from_world_ = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
    brick_ = test::brick_model();
    SurfaceMap map = surface_map(
        test::render({test::table(camera_from_world_)}, test::kinect_camera(), 1, 8).frame, {});
    planes_ = label_background_planes(map, {});
    ASSERT_EQ(planes_.size(), 1u);
    image_ = make_check_image(map);
  }
  // Of the brick, turned by `tilt` about its long axis, with its centre `height` above the table.
  RestingAgreement at(double height, double tilt = 0) const {
    const Pose world_from_object{rotation_from_vector(tilt * Eigen::Vector3d::UnitX()),
                                 {0, 0, height}};
    return compare_resting(image_, planes_, *brick_, camera_from_world_ * world_from_object);
  }

  Pose camera_from_world_;
  std::shared_ptr<const ObjectModel> brick_;
  CheckImage image_;
  std::vector<Plane> planes_;
};

constexpr double kHalfHeight = 0.025, kHalfWidth = 0.040;  // of the brick

TEST_F(RestingScore, TheGapIsTheHeightOfTheLowestPointBeyondACentimetre) {
  for (const double above : {-0.03, 0.05, 0.1}) {
    const double offset = std::copysign(0.010, above);
    EXPECT_NEAR(at(kHalfHeight + above).gap, above - offset, 0.003) << above;
  }
  for (const double above : {-0.006, 0.0, 0.006}) {
    EXPECT_EQ(at(kHalfHeight + above).gap, 0) << "within what the sensor may be off";
  }
  EXPECT_NEAR(at(0.6).gap, 0.2, 1e-6) << "clamped";
  // On an edge, at 45 degrees.
  EXPECT_NEAR(at(std::sqrt(0.5) * (kHalfHeight + kHalfWidth), M_PI / 4).gap, 0, 0.004);
}

TEST_F(RestingScore, PointsBeneathTheTableAreCounted) {
  EXPECT_EQ(at(kHalfHeight).below, 0);
  EXPECT_EQ(at(0.2).below, 0);
  // Sunk to its middle: the bottom, and half of the sides.
  const double bottom = 4 * 0.06 * 0.04, sides = 2 * 2 * (0.06 + 0.04) * 2 * 0.025;
  const double expected = (bottom + 0.5 * sides) / (2 * bottom + sides);
  EXPECT_NEAR(at(0).below, expected, 0.12) << "less what is within noise of the table";
  EXPECT_GT(at(-kHalfHeight - 0.02).below, 0.9);
}

TEST_F(RestingScore, StandsOnItsFaceAndFallsFromItsEdge) {
  const double diameter = brick_->diameter;
  EXPECT_NEAR(at(kHalfHeight).balance, kHalfWidth / diameter, 0.03) << "inside by half the width";
  EXPECT_NEAR(at(kHalfWidth, M_PI / 2).balance, kHalfHeight / diameter, 0.03);
  // On an edge: beside it lies the centre, where the two half sides differ.
  const double tilt = M_PI / 4;
  const double beside = std::sqrt(0.5) * (kHalfWidth - kHalfHeight);
  const double balance = at(std::sqrt(0.5) * (kHalfHeight + kHalfWidth), tilt).balance;
  // What is within 4 mm of the lowest point counts as contact: beside the edge, 6 mm.
  EXPECT_NEAR(balance, (0.006 - beside) / diameter, 0.03);
  EXPECT_LT(balance, 0.2 * at(kHalfHeight).balance);
  EXPECT_TRUE(std::isnan(at(0.2).balance)) << "touches nothing";
}

TEST_F(RestingScore, NothingIsKnownWithoutPlanes) {
  const RestingAgreement none = compare_resting(image_, {}, *brick_, camera_from_world_);
  EXPECT_TRUE(std::isnan(none.below));
  EXPECT_TRUE(std::isnan(none.gap));
  EXPECT_TRUE(std::isnan(none.balance));
}

}  // namespace
}  // namespace bpa::score
