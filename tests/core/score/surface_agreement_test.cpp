// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/surface_agreement.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/model/model_index.hpp"
#include "core/score/score_layer.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::score {
namespace {

using test::Solid;

class SurfaceAgreementOf : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    l_ = test::l_model();
    brick_ = test::brick_model();
  }
  static void TearDownTestSuite() {
    l_.reset();
    brick_.reset();
  }
  static SurfaceMap map_of(const std::vector<Solid>& solids, float noise = 0) {
    return surface_map(test::render(solids, test::kinect_camera(), noise, 8).frame, {});
  }
  static CheckImage image_of(const std::vector<Solid>& solids, float noise = 0) {
    return make_check_image(map_of(solids, noise));
  }
  static std::vector<Solid> l_on_table() {
    return test::together({test::table(test::kCameraFromWorld)}, test::l_solids(truth_));
  }

  // Of the surface alone.
  static double log_odds(const CheckImage& image, const ObjectModel& model, const Pose& pose) {
    SceneFeatures scene;
    scene.image = image;
    const FeaturePlaces places(model);
    Evidence evidence(scene, places, pose);
    return default_score_layers().round_three.log_odds(measure(evidence, Round::two));
  }

  static inline std::shared_ptr<const ObjectModel> l_, brick_;
  static inline const Pose truth_ = test::kCameraFromWorld * test::standing_at(0, 0, 0.02, 0.7);
};

TEST_F(SurfaceAgreementOf, ComponentsOfTheTruthAreNearlyPerfect) {
  const SurfaceAgreement c = measure_surface(image_of(l_on_table()), *l_, truth_);
  EXPECT_GT(c.range, -0.15);
  EXPECT_GT(c.normal, -0.2);
  EXPECT_GT(c.visibility, 0.9);
  EXPECT_GT(c.agreeing, 0.85);
  EXPECT_LT(c.free_space, 0.05);
  EXPECT_GT(c.edge, -0.25);
  EXPECT_GT(c.edge_visibility, 0.9);
  EXPECT_GT(c.shape, 0.05) << "several faces are seen";
}

TEST_F(SurfaceAgreementOf, TruthScoresHigherThanWhatIsBesideIt) {
  for (const float noise : {0.0f, 1.0f}) {
    const CheckImage image = image_of(l_on_table(), noise);
    const double best = log_odds(image, *l_, truth_);
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const auto score = [&](double distance, double angle) {
        return log_odds(image, *l_, test::disturbed(truth_, distance, angle, seed));
      };
      EXPECT_LT(score(0.03, 0), best);
      EXPECT_LT(score(0, 0.3), best);
      EXPECT_LT(score(0.2, 2), best - 3);
    }
  }
}

TEST_F(SurfaceAgreementOf, WhatHidesItDoesNotCountAgainstIt) {
  const Eigen::Vector3d middle = truth_ * Eigen::Vector3d(0, 0, 0.02);
  const Solid board{Solid::Kind::box,
                    {0.5, 0.5, 0.005},
                    {Eigen::Quaterniond::Identity(), 0.6 * middle + Eigen::Vector3d(0.5, 0, 0)}};
  const SurfaceAgreement open = measure_surface(image_of(l_on_table()), *l_, truth_);
  const CheckImage image = image_of(test::together(l_on_table(), {board}));
  const SurfaceAgreement hidden = measure_surface(image, *l_, truth_);
  EXPECT_LT(hidden.visibility, open.visibility - 0.2);
  EXPECT_GT(hidden.range, open.range - 0.1);
  EXPECT_GT(hidden.normal, open.normal - 0.1);
  EXPECT_GT(hidden.agreeing, open.agreeing - 0.1);
  EXPECT_LT(hidden.free_space, 0.05);
  EXPECT_LT(hidden.explained_pixels, open.explained_pixels);
  EXPECT_NEAR(hidden.expected_pixels, open.expected_pixels, 1);
}

TEST_F(SurfaceAgreementOf, TheImageBorderHides) {
  const CheckImage whole = image_of(l_on_table());
  CheckImage left = whole;
  left.width = static_cast<int>(whole.project(truth_.translation.cast<float>()).x());
  left.pixels.clear();
  for (int v = 0; v < whole.height; ++v) {
    const auto row = whole.pixels.begin() + v * whole.width;
    left.pixels.insert(left.pixels.end(), row, row + left.width);
  }
  const auto pixels = explained_pixels(whole, *l_, truth_);
  const auto inside = std::ranges::count_if(pixels, [&](std::uint32_t pixel) {
    return static_cast<int>(pixel) % whole.width < left.width;
  });
  const double share = static_cast<double>(inside) / static_cast<double>(pixels.size());
  const SurfaceAgreement all = measure_surface(whole, *l_, truth_);
  const SurfaceAgreement cut = measure_surface(left, *l_, truth_);
  EXPECT_NEAR(cut.visibility, share * all.visibility, 0.1);
  EXPECT_NEAR(cut.edge_visibility, share * all.edge_visibility, 0.2);
  EXPECT_NEAR(cut.explained_pixels, share * all.explained_pixels, 0.1 * all.explained_pixels);
  EXPECT_NEAR(cut.expected_pixels, all.expected_pixels, 1e-6);
  EXPECT_GT(cut.agreeing, all.agreeing - 0.1);
}

// A pose that is off by less than a pixel's width is no evidence of free space.
TEST_F(SurfaceAgreementOf, WhatIsSeenBesideTheSilhouetteCountsForLittle) {
  const CheckImage image = image_of(l_on_table());
  for (const double x : {-0.003, 0.003}) {
    Pose beside = truth_;
    beside.translation.x() += x;
    const SurfaceAgreement c = measure_surface(image, *l_, beside);
    EXPECT_LT(c.free_space, 0.02);
    EXPECT_GT(c.range, -0.2);
  }
  Pose far = truth_;
  far.translation.x() += 0.03;
  EXPECT_GT(measure_surface(image, *l_, far).free_space, 0.08);
}

TEST_F(SurfaceAgreementOf, FreeSpaceCountsAgainstIt) {
  const CheckImage image = image_of({test::table(test::kCameraFromWorld)});
  const Pose above = test::kCameraFromWorld * test::standing_at(0, 0, 0.15, 0.7);
  const SurfaceAgreement c = measure_surface(image, *l_, above);
  EXPECT_GT(c.free_space, 0.9);
  EXPECT_LT(c.agreeing, 0.1);
}

TEST_F(SurfaceAgreementOf, AFaceInTheMiddleOfALargePlaneIsPenalised) {
  // The brick sunk into the table: its top is where the table is, but nothing ends there.
  const Pose sunk = test::kCameraFromWorld *
                    test::standing_at(0, 0, -static_cast<double>(test::kBrickHalf.z()), 0.3);
  const CheckImage table = image_of({test::table(test::kCameraFromWorld)});
  const SurfaceAgreement flush = measure_surface(table, *brick_, sunk);
  const Pose on = test::kCameraFromWorld *
                  test::standing_at(0, 0, static_cast<double>(test::kBrickHalf.z()), 0.3);
  const CheckImage both = image_of({test::table(test::kCameraFromWorld), test::brick_solid(on)});
  const SurfaceAgreement standing = measure_surface(both, *brick_, on);
  EXPECT_LT(flush.edge, -0.4);
  EXPECT_GT(standing.edge, -0.25);
  EXPECT_LT(flush.edge_support, standing.edge_support - 0.3);
  EXPECT_LT(flush.shape, 0.02) << "one flat face";
  EXPECT_GT(log_odds(both, *brick_, on), log_odds(table, *brick_, sunk) + 2);
}

TEST_F(SurfaceAgreementOf, ExplainsThePixelsOfTheObject) {
  const auto rendered = test::render(l_on_table(), test::kinect_camera());
  const SurfaceMap map = surface_map(rendered.frame, {});
  const CheckImage image = make_check_image(map);
  const SurfaceAgreement c = measure_surface(image, *l_, truth_);
  const std::vector<std::uint32_t> explained = explained_pixels(image, *l_, truth_);
  // The pixels counted one by one, and those that the surface points cover by their area.
  EXPECT_NEAR(c.explained_pixels, static_cast<double>(explained.size()),
              0.25 * static_cast<double>(explained.size()));
  EXPECT_LE(c.explained_pixels, c.expected_pixels);
  EXPECT_TRUE(std::is_sorted(explained.begin(), explained.end()));
  EXPECT_EQ(std::adjacent_find(explained.begin(), explained.end()), explained.end());
  int on_object = 0, seen = 0;
  const auto is_l = [&](std::size_t i) { return rendered.solid[rendered.index_of(map, i)] >= 1; };
  for (const std::uint32_t i : explained) on_object += is_l(i);
  for (std::size_t i = 0; i < map.size(); ++i) seen += is_l(i);
  EXPECT_GT(on_object, 0.95 * static_cast<double>(explained.size()));
  EXPECT_GT(on_object, 0.7 * seen);
}

TEST_F(SurfaceAgreementOf, OutOfViewIsImprobable) {
  const CheckImage image = image_of(l_on_table());
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(9, 0, 1),
                                       Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, 1e4)}) {
    const SurfaceAgreement c = measure_surface(image, *l_, {truth_.rotation, place});
    EXPECT_EQ(c.explained_pixels, 0);
    const double score = log_odds(image, *l_, {truth_.rotation, place});
    EXPECT_LT(score, log_odds(image, *l_, truth_) - 3);
    EXPECT_TRUE(std::isfinite(score));
  }
}

TEST_F(SurfaceAgreementOf, NoDepthIsNeitherForNorAgainst) {
  auto rendered = test::render(l_on_table(), test::kinect_camera());
  for (std::size_t i = 0; i < rendered.frame.depth.size(); ++i) {
    if (rendered.solid[i] >= 1 && i % 640 < 320) rendered.frame.depth[i] = 0;
  }
  const SurfaceAgreement c =
      measure_surface(make_check_image(surface_map(rendered.frame, {})), *l_, truth_);
  EXPECT_GT(c.agreeing, 0.8);
  EXPECT_GT(c.range, -0.2);
  EXPECT_LT(c.free_space, 0.05);
}

TEST_F(SurfaceAgreementOf, AFewPointsSayNearlyTheSameAsAll) {
  const CheckImage image = image_of(l_on_table(), 1);
  const SurfaceAgreement all = measure_surface(image, *l_, truth_);
  const SurfaceAgreement few = measure_surface(image, *l_, truth_, 200);
  EXPECT_NEAR(few.range, all.range, 0.06);
  EXPECT_NEAR(few.normal, all.normal, 0.06);
  EXPECT_NEAR(few.agreeing, all.agreeing, 0.08);
  EXPECT_NEAR(few.explained_pixels, all.explained_pixels, 0.15 * all.explained_pixels);
  EXPECT_NEAR(few.edge_support, all.edge_support, 0.2);
}

}  // namespace
}  // namespace bpa::score
