// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/overlaps.hpp"

#include <gtest/gtest.h>

#include "tests/support/posed_models.hpp"

namespace bpa::scene {
namespace {

class OverlapsOf : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { brick_ = test::brick_model(); }
  static void TearDownTestSuite() { brick_.reset(); }

  // A brick whose centre is at (x, y, 1) metres, explaining pixels of its own.
  static detect::Candidate brick_at(double x, double y, std::uint32_t first_pixel) {
    detect::Candidate out;
    out.model = brick_.get();
    out.refinement.frame_from_object.translation = {x, y, 1};
    for (std::uint32_t k = 0; k < 100; ++k) out.explained.push_back(first_pixel + k);
    return out;
  }
  static bool conflict(const detect::Candidate& a, const detect::Candidate& b) {
    const auto overlaps = find_overlaps({a, b}, -8);
    EXPECT_EQ(overlaps[0].empty(), overlaps[1].empty());
    return !overlaps[0].empty() && overlaps[0][0].conflicting;
  }

  static inline std::shared_ptr<const ObjectModel> brick_;
};

TEST_F(OverlapsOf, SolidThingsDoNotStandInOneAnother) {
  const double length = 2 * static_cast<double>(test::kBrickHalf.x());
  const detect::Candidate first = brick_at(0, 0, 0);
  EXPECT_FALSE(conflict(first, brick_at(length, 0, 500))) << "end to end";
  EXPECT_FALSE(conflict(first, brick_at(length - 0.008, 0, 500))) << "as exact as poses are";
  EXPECT_TRUE(conflict(first, brick_at(0.6 * length, 0, 500)));
  EXPECT_TRUE(conflict(first, brick_at(0.6 * length, 0.02, 500)));
  EXPECT_FALSE(conflict(first, brick_at(0.3, 0, 500)));
}

TEST_F(OverlapsOf, EqualObjectsMayLieNearerThanTheirLength) {
  const double thickness = 2 * static_cast<double>(test::kBrickHalf.z());
  ASSERT_LT(thickness, 0.4 * brick_->diameter);
  detect::Candidate second = brick_at(0, 0, 500);
  second.refinement.frame_from_object.translation.z() += thickness;
  EXPECT_FALSE(conflict(brick_at(0, 0, 0), second)) << "stacked";
  second.refinement.frame_from_object.translation += Eigen::Vector3d(0.02, 0, -0.5 * thickness);
  EXPECT_TRUE(conflict(brick_at(0, 0, 0), second));
}

TEST_F(OverlapsOf, AThinModelIsInOnePlaceByItsCentre) {
  ModelSource card = *brick_;
  for (Eigen::Vector3f& p : card.surface.points) p.z() *= 0.006f / (2 * test::kBrickHalf.z());
  card.prepared.reset();
  const auto model = make_object_model(std::move(card)).value();
  detect::Candidate first = brick_at(0, 0, 0), second = brick_at(0.02, 0, 500);
  first.model = second.model = model.get();
  EXPECT_TRUE(conflict(first, second)) << "6 mm thick";
  second.refinement.frame_from_object.translation.x() = 0.1;
  EXPECT_FALSE(conflict(first, second));
}

TEST_F(OverlapsOf, AModelSeenFromOneSideHasNoInside) {
  ModelSource open = *brick_;
  open.complete = false;
  detect::Candidate first = brick_at(0, 0, 0), second = brick_at(0.072, 0, 500);
  EXPECT_TRUE(conflict(first, second));
  const auto model = make_object_model(std::move(open)).value();
  first.model = model.get();
  EXPECT_FALSE(conflict(first, second));
}

// Scans have their origin anywhere.
TEST_F(OverlapsOf, ThePlaceIsThatOfTheCentreNotOfTheOrigin) {
  const Eigen::Vector3f shift(0.2f, -0.1f, 0.05f);
  ModelSource source = *brick_;
  for (Eigen::Vector3f& p : source.surface.points) p += shift;
  const auto model = make_object_model(std::move(source)).value();
  EXPECT_LT((model->centre - shift.cast<double>()).norm(), 1e-3);
  const auto moved = [&](const detect::Candidate& candidate, double turn) {
    detect::Candidate out = candidate;
    out.model = model.get();
    const Pose brick_from_model{Eigen::Quaterniond::Identity(), -shift.cast<double>()};
    out.refinement.frame_from_object =
        candidate.pose() * Pose{rotation_from_vector({0, 0, turn}), {0, 0, 0}} * brick_from_model;
    return out;
  };
  const detect::Candidate at_origin = brick_at(0, 0, 0);
  for (const double x : {0.0, 0.03, 0.06, 0.3}) {
    const detect::Candidate beside = brick_at(x, 0, 500);
    EXPECT_EQ(conflict(moved(at_origin, 0), moved(beside, 0)), conflict(at_origin, beside)) << x;
  }
  EXPECT_TRUE(conflict(moved(at_origin, 0), moved(brick_at(0, 0, 500), 2)));
}

TEST_F(OverlapsOf, AThingMayLieOnATray) {
  const float thickness = 0.010f;
  detect::Candidate tray = brick_at(0, 0, 500);
  const auto model = test::model_of(test::box_mesh({0.08f, 0.08f, thickness / 2}), "tray", 3);
  tray.model = model.get();
  detect::Candidate brick = brick_at(0, 0, 0);
  EXPECT_TRUE(conflict(tray, brick)) << "through the middle of the brick";
  tray.refinement.frame_from_object.translation.z() +=
      static_cast<double>(test::kBrickHalf.z() + thickness / 2);
  EXPECT_FALSE(conflict(tray, brick));
  ModelSource open = *tray.model;
  open.complete = false;
  const auto open_model = make_object_model(std::move(open)).value();
  tray.model = open_model.get();
  EXPECT_TRUE(conflict(tray, brick)) << "of a model seen from one side only its place is known";
}

TEST_F(OverlapsOf, PixelsAreOwnedOnce) {
  const detect::Candidate first = brick_at(0, 0, 0);
  EXPECT_TRUE(conflict(first, brick_at(0.5, 0, 60))) << "40 of 100 pixels shared";
  const auto overlaps = find_overlaps({first, brick_at(0.5, 0, 80)}, -8);
  ASSERT_EQ(overlaps[0].size(), 1u);
  EXPECT_EQ(overlaps[0][0].common, 20);
  EXPECT_FALSE(overlaps[0][0].conflicting);
}

TEST_F(OverlapsOf, TheHopelessTakeNothingFromOthers) {
  detect::Candidate hopeless = brick_at(0, 0, 0);
  hopeless.score = -9;
  EXPECT_FALSE(conflict(brick_at(0, 0, 0), hopeless));
}

}  // namespace
}  // namespace bpa::scene
