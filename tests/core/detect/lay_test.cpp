// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/detect/stages.hpp"
#include "core/model/model_index.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::detect {
namespace {

const Eigen::Vector3f kCardHalf(0.060f, 0.025f, 0.002f);

// A red card of 4 mm on a white table. Depth shows the table alone: a card is thinner than noise.
class LayFlat : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SymmetryGroup half_turns;
    for (int axis = 0; axis < 3; ++axis) {
      half_turns.discrete.push_back(
          {rotation_from_vector(M_PI * Eigen::Vector3d::Unit(axis)), {0, 0, 0}});
    }
    card_ = test::model_of(test::box_mesh(kCardHalf), "card", 1, half_turns);
  }
  static void TearDownTestSuite() { card_.reset(); }

  static SceneFeatures scene(bool colors, int num_threads = 0) {
    const test::SolidImage table =
        test::render({test::table(test::kCameraFromWorld)}, test::kinect_camera(), 1, 8);
    SurfaceMap map = surface_map(table.frame, {});
    std::vector<Plane> planes = label_background_planes(map, {});
    ColorImages images;
    if (colors) images.reduced = painted(map);
    SceneFeatureOptions options;
    options.num_threads = num_threads;
    return scene_features(std::move(map), std::move(planes), options, std::move(images));
  }
  static Image<Eigen::Vector3f> painted(const SurfaceMap& map) {
    Image<Eigen::Vector3f> rgb(map.width(), map.height(), {230, 230, 230});
    const Pose card_from_camera = truth_.inverse();
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Eigen::Vector3d at = card_from_camera * map.points[i].cast<double>();
      const Eigen::Vector2d half = kCardHalf.head<2>().cast<double>();
      if ((at.head<2>().cwiseAbs() - half).maxCoeff() < 0) rgb[i] = {200, 30, 30};
    }
    return rgb;
  }
  static PoseError error_of(const Candidate& candidate) {
    return pose_error(candidate.pose(), truth_, card_->symmetry);
  }
  static bool any_right(const Candidates& candidates) {
    return std::ranges::any_of(candidates, [](const Candidate& candidate) {
      return error_of(candidate).position < 0.01 && error_of(candidate).angle < 0.1;
    });
  }

  static inline std::shared_ptr<const ObjectModel> card_;
  static inline const Pose truth_ =
      test::kCameraFromWorld * test::standing_at(0.06, 0.03, 0.002, 0.7);
};

TEST_F(LayFlat, FindsACardThatDepthDoesNotShow) {
  const SceneFeatures seen = scene(true);
  const Search search(seen, *card_);
  EXPECT_FALSE(any_right(check(search, sample(search, {}))));
  const Candidates laid = lay(search, {});
  ASSERT_TRUE(any_right(laid));
  EXPECT_LE(std::ssize(laid), LayOptions().max_laid);
  for (const Candidate& candidate : laid) {
    EXPECT_EQ(candidate.found_by, Source::region);
    const Eigen::Vector3d bottom = test::kCameraFromWorld.inverse() * candidate.place();
    EXPECT_NEAR(bottom.z(), 0.002, 0.003) << "in contact with the table";
  }
}

TEST_F(LayFlat, ChangesNoOtherCandidate) {
  const SceneFeatures seen = scene(true);
  const Search search(seen, *card_);
  Candidates others(3, Candidate{.model = card_.get(), .score = 1});
  others[1].refinement.frame_from_object = test::disturbed(truth_, 0.1, 0.2, 5);
  const Candidates after = lay(search, others);
  ASSERT_GT(after.size(), others.size());
  for (std::size_t i = 0; i < others.size(); ++i) {
    EXPECT_EQ(after[i].pose().translation, others[i].pose().translation);
    EXPECT_EQ(after[i].score, others[i].score);
  }
}

TEST_F(LayFlat, GivesTheSameForAnyThreads) {
  const SceneFeatures one = scene(true, 1), many = scene(true, 8);
  const Candidates a = lay(Search(one, *card_), {}), b = lay(Search(many, *card_), {});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pose().translation, b[i].pose().translation);
    EXPECT_EQ(a[i].score, b[i].score);
  }
}

TEST_F(LayFlat, AddsNothingWithoutRegionsForThickModelsOrWhereItIsOff) {
  const SceneFeatures plain = scene(false), seen = scene(true);
  EXPECT_TRUE(lay(Search(plain, *card_), {}).empty()) << "no colours";
  const auto cube = test::model_of(test::box_mesh({0.03f, 0.03f, 0.03f}), "cube", 2);
  EXPECT_TRUE(lay(Search(seen, *cube), {}).empty());
  DetectOptions off;
  off.lay.max_laid = 0;
  EXPECT_TRUE(lay(Search(seen, *card_, off), {}).empty());
}

}  // namespace
}  // namespace bpa::detect
