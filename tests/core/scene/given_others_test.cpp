// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/given_others.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/score/surface_agreement.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::scene {
namespace {

enum { kBack, kFront };

// A brick in front of a wall, half hidden by another. Which pixel shows what is known from rays.
class GivenOthers : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { brick_ = test::brick_model(); }
  static void TearDownTestSuite() { brick_.reset(); }

  void SetUp() override {
    const test::Solid wall{test::Solid::Kind::box, {2, 2, 0.1}, at(0, 0, 1.6)};
    const std::vector<test::Solid> bricks{test::brick_solid(kPlaces[kBack]),
                                          test::brick_solid(kPlaces[kFront])};
    const Camera camera = test::kinect_camera();
    const test::SolidImage both = test::render(test::together(bricks, {wall}), camera);
    const test::SolidImage alone = test::render({bricks[kBack]}, camera);
    scene_.map = surface_map(both.frame, {});
    scene_.image = make_check_image(scene_.map);
    for (const Pose& place : kPlaces) {
      detect::Candidate& candidate = candidates_.emplace_back();
      candidate.model = brick_.get();
      candidate.refinement.frame_from_object = place;
      candidate.probability = 0.9;
      candidate.explained = score::explained_pixels(scene_.image, *brick_, place);
    }
    segment::Segmentation& segmentation = scene_.segmentation;  // all that is nearer than the wall
    segmentation.labels = Image<std::int32_t>(scene_.map.width(), scene_.map.height(), -1);
    segmentation.segments.resize(1);
    for (std::size_t i = 0; i < scene_.map.size(); ++i) {
      const std::size_t pixel = both.index_of(scene_.map, i);
      const int seen = both.solid[pixel];
      if (alone.solid[pixel] == kBack) ++covered_, hidden_ += seen == kFront;
      if (seen != kBack && seen != kFront) continue;
      ++shown_[seen];
      segmentation.labels[i] = 0;
      segmentation.segments[0].pixels.push_back(static_cast<std::uint32_t>(i));
    }
  }

  static Pose at(double x, double y, double z) {
    return {Eigen::Quaterniond::Identity(), {x, y, z}};
  }
  // A component of the brick at the back, given the others.
  double measured(std::string_view name, const Present& present,
                  const Overlaps& overlaps = Overlaps(2)) {
    measure_given_others(scene_, overlaps, present, candidates_, -8, 1);
    for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
      if (score::kScoreComponents[i].name == name) return candidates_[kBack].values[i];
    }
    return score::kNotKnown;
  }
  double hidden() const { return static_cast<double>(hidden_) / covered_; }
  // Of the pixels of both, those of the one in front.
  double left() const { return static_cast<double>(shown_[kFront]) / (shown_[0] + shown_[1]); }

  static inline const Pose kPlaces[2] = {at(0, 0, 1), at(0.04, 0, 0.8)};
  static inline std::shared_ptr<const ObjectModel> brick_;
  SceneFeatures scene_;
  detect::Candidates candidates_;
  int covered_ = 0, hidden_ = 0, shown_[2] = {};
};

TEST_F(GivenOthers, WhatAnotherHidesIsHiddenByWhatIsKnown) {
  ASSERT_GT(hidden(), 0.3);
  ASSERT_LT(hidden(), 0.8);
  EXPECT_NEAR(measured("hidden_by_unknown", {true, true}), 0, 0.03);
  EXPECT_NEAR(measured("hidden_by_unknown", {true, false}), hidden(), 0.05);
  EXPECT_NEAR(measured("hidden_by_unknown", {false, false}), hidden(), 0.05);
}

TEST_F(GivenOthers, WhatAnotherExplainsIsNotLeftOver) {
  EXPECT_NEAR(measured("left_over", {true, true}), 0, 0.05);
  EXPECT_NEAR(measured("left_over", {true, false}), left(), 0.05);
}

TEST_F(GivenOthers, ExposureIsRelativeToThatOfOthers) {
  candidates_[kBack].values[score::component("exposure")] = -1;
  candidates_[kFront].values[score::component("exposure")] = 0.2;
  EXPECT_NEAR(measured("relative_exposure", {true, true}), -1.2, 1e-12);
  EXPECT_TRUE(std::isnan(measured("relative_exposure", {true, false})))
      << "nothing to compare with";
  candidates_[kFront].values[score::component("exposure")] = score::kNotKnown;
  EXPECT_TRUE(std::isnan(measured("relative_exposure", {true, true}))) << "a model without colours";
}

// The brick at the back beside sure others of its model and of another: log((own + 1) / (most +
// 1)).
TEST_F(GivenOthers, CopiesCountWhereAModelHasTwo) {
  const auto other = std::make_shared<ObjectModel>(*brick_);
  const auto copies = [&](int own, int of_another, double probability) {
    candidates_.resize(1, candidates_[kBack]);
    Present present{0};
    for (int i = 0; i < own + of_another; ++i) {
      candidates_.push_back({.model = i < own ? brick_.get() : other.get(), .score = -100});
      present.push_back(probability);
    }
    return measured("copies", present, Overlaps(candidates_.size()));
  };
  EXPECT_TRUE(std::isnan(copies(0, 0, 0.9)));
  EXPECT_TRUE(std::isnan(copies(1, 1, 0.9))) << "no model has two";
  EXPECT_NEAR(copies(2, 1, 0.9), std::log(3.0 / 2), 1e-12);
  EXPECT_NEAR(copies(0, 4, 0.9), -std::log(5.0), 1e-12);
  EXPECT_TRUE(std::isnan(copies(4, 0, 0.8))) << "not sure";
}

// It cannot be there when the placement in question is.
TEST_F(GivenOthers, ARivalIsNoOther) {
  Overlaps overlaps(2);
  overlaps[kBack] = {{kFront, 0, true}};
  EXPECT_NEAR(measured("hidden_by_unknown", {true, true}, overlaps), hidden(), 0.05);
  EXPECT_NEAR(measured("left_over", {true, true}, overlaps), left(), 0.05);
}

TEST_F(GivenOthers, HopelessPlacementsAreNotMeasured) {
  candidates_[kBack].values.fill(score::kNotKnown);
  candidates_[kBack].score = -9;
  EXPECT_TRUE(std::isnan(measured("left_over", {false, true})));
}

TEST_F(GivenOthers, TheFirstInterpretationHoldsTheMostProbableThatDoNotConflict) {
  detect::Candidates three(3);
  three[0].probability = 0.6;
  three[1].probability = 0.8;
  three[2].probability = 0.2;
  Overlaps overlaps(3);
  EXPECT_EQ(first_interpretation(three, overlaps), (Present{0.6, 0.8, 0}));
  three[2].probability = 0.55;
  overlaps[0] = {{1, 7, true}};
  overlaps[1] = {{0, 7, true}, {2, 7, false}};
  overlaps[2] = {{1, 7, false}};
  EXPECT_EQ(first_interpretation(three, overlaps), (Present{0, 0.8, 0.55}));
}

}  // namespace
}  // namespace bpa::scene
