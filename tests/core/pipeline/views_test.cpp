// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/views.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/posed_models.hpp"

namespace bpa {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// An L that a wall hides from the first camera, and a brick that both cameras see.
class ViewsOf : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto library = std::make_shared<ModelLibrary>();
    EXPECT_TRUE(library->add(test::l_model()).ok());
    EXPECT_TRUE(library->add(test::brick_model()).ok());
    library_ = library;
    views_ = {view_from({0.1, -0.6, 0.5}, 8), view_from({-0.35, 0.5, 0.45}, 9)};
    views_[0].frame.frame_id = "front";
    views_[1].frame.frame_id = "back";
    views_[0].frame.stamp_ns = 5;
    views_[1].frame.stamp_ns = 7;
  }
  static void TearDownTestSuite() {
    library_.reset();
    views_.clear();
  }

  static View view_from(const Eigen::Vector3d& eye, std::uint64_t seed) {
    const Pose camera_from_world = test::look_at(eye, {0, 0, 0});
    const test::Solid wall{test::Solid::Kind::box,
                           {0.10, 0.01, 0.08},
                           camera_from_world * test::standing_at(-0.1, -0.12, 0.08, 0)};
    const auto solids = test::together(test::together({test::table(camera_from_world), wall},
                                                      test::l_solids(camera_from_world * l_truth_)),
                                       {test::brick_solid(camera_from_world * brick_truth_)});
    return {test::render(solids, test::kinect_camera(), 1, seed).frame,
            camera_from_world.inverse()};
  }

  static Detector detector(ViewsOptions views = {}) {
    DetectorOptions options;  // enough for two objects
    options.features.max_references = 200;
    options.detect.refine.max_refined = 10;
    options.scene.annealing_steps = 3000;
    options.views = views;
    return Detector(library_, options);
  }
  static ViewsResult found(const std::vector<View>& views, const DetectRequest& request = {},
                           const ViewsOptions& options = {}) {
    auto result = detect_views(detector(options), views, request);
    EXPECT_TRUE(result.ok()) << result.status().message;
    return result.ok() ? std::move(*result) : ViewsResult{};
  }
  static const Placement* placement_of(const ViewsResult& result, const std::string& model) {
    for (const Placement& placement : result.scene.interpretations.at(0).placements) {
      if (placement.model == model) return &placement;
    }
    return nullptr;
  }
  static std::string refusal(const std::vector<View>& views) {
    const auto result = detect_views(detector(), views);
    EXPECT_EQ(result.status().code, StatusCode::invalid_argument);
    return result.status().message;
  }

  static inline const Pose l_truth_ = test::standing_at(-0.08, 0, 0.02, 0.7);
  static inline const Pose brick_truth_ =
      test::standing_at(0.12, 0.02, static_cast<double>(test::kBrickHalf.z()), -0.4);
  static inline std::shared_ptr<const ModelLibrary> library_;
  static inline std::vector<View> views_;
};

TEST_F(ViewsOf, PosesAreInTheFixedFrame) {
  const ViewsResult result = found(views_);
  EXPECT_EQ(result.scene.stamp_ns, 7);
  EXPECT_TRUE(result.warnings.empty());
  ASSERT_EQ(result.disagreements.size(), 1u);
  for (const auto& [name, truth] : {std::pair{"l", l_truth_}, std::pair{"brick", brick_truth_}}) {
    const Placement* placement = placement_of(result, name);
    ASSERT_NE(placement, nullptr) << name;
    const PoseError error =
        pose_error(placement->frame_from_object, truth, library_->find(name)->symmetry);
    EXPECT_LT(error.position, 0.004) << name;
    EXPECT_LT(error.angle, 2 * kDegree) << name;
  }
  EXPECT_EQ(result.scene.interpretations[0].placements.size(), 2u);
}

TEST_F(ViewsOf, WhatOneViewHidesAnotherFinds) {
  const ViewsResult front = found({views_[0]}), both = found(views_);
  const Placement* hidden = placement_of(front, "l");
  const Placement* seen = placement_of(both, "l");
  ASSERT_NE(seen, nullptr);
  EXPECT_GT(seen->probability, 0.9);
  EXPECT_LT(hidden ? hidden->visible_fraction : 0, 0.5 * seen->visible_fraction);
}

TEST_F(ViewsOf, OneViewGivesWhatItsFrameGives) {
  const auto alone = detector().detect(views_[1].frame);
  ASSERT_TRUE(alone.ok());
  const ViewsResult result = found({views_[1]});
  const auto& expected = alone->interpretations.at(0).placements;
  const auto& placements = result.scene.interpretations.at(0).placements;
  ASSERT_EQ(placements.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Pose pose = views_[1].scene_from_camera * expected[i].frame_from_object;
    EXPECT_EQ(placements[i].frame_from_object.translation, pose.translation);
    EXPECT_EQ(placements[i].probability, expected[i].probability);
  }
}

TEST_F(ViewsOf, TheSameForAnyNumberOfThreads) {
  DetectRequest one, four;
  one.num_threads = 1;
  four.num_threads = 4;
  const ViewsResult a = found(views_, one), b = found(views_, four);
  ASSERT_EQ(a.scene.interpretations.size(), b.scene.interpretations.size());
  for (std::size_t k = 0; k < a.scene.interpretations.size(); ++k) {
    const Interpretation& x = a.scene.interpretations[k];
    const Interpretation& y = b.scene.interpretations[k];
    ASSERT_EQ(x.score, y.score);
    ASSERT_EQ(x.placements.size(), y.placements.size());
    for (std::size_t i = 0; i < x.placements.size(); ++i) {
      EXPECT_EQ(x.placements[i].frame_from_object.translation,
                y.placements[i].frame_from_object.translation);
      EXPECT_EQ(x.placements[i].covariance, y.placements[i].covariance);
      EXPECT_EQ(x.placements[i].probability, y.placements[i].probability);
    }
  }
  EXPECT_EQ(a.scene.effort, b.scene.effort);
}

TEST_F(ViewsOf, AWrongCameraIsNamedAndMovedBack) {
  std::vector<View> wrong = views_;
  Pose& camera = wrong[1].scene_from_camera;
  camera.translation.z() += 0.012;  // both see the table
  const ViewsResult result = found(wrong);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_EQ(result.warnings[0].find("cameras \"front\" and \"back\" disagree by "), 0u);
  EXPECT_NEAR(result.disagreements[0].position_m, 0.012, 0.002);
  const auto relative = [](const std::vector<Pose>& poses) {
    return poses[0].inverse() * poses[1];
  };
  const Pose truth = relative({views_[0].scene_from_camera, views_[1].scene_from_camera});
  EXPECT_LT(pose_error(relative(result.scene_from_camera), truth).position, 0.003);
  ViewsOptions as_given;
  as_given.align_cameras = false;
  EXPECT_EQ(found(wrong, {}, as_given).scene_from_camera[1].translation, camera.translation);
}

TEST_F(ViewsOf, BadInputIsRefused) {
  EXPECT_EQ(refusal({}), "there are 0 views; there must be 1 to 16");
  std::vector<View> turned = views_;
  turned[1].scene_from_camera.rotation.coeffs() *= 2;
  EXPECT_EQ(refusal(turned).find("views[1].scene_from_camera is no rigid motion"), 0u);
  std::vector<View> blind = views_;
  blind[1].frame.depth.assign(blind[1].frame.depth.size(), 0);
  EXPECT_EQ(refusal(blind).find("views[1]: "), 0u);
}

TEST(CombinedLogOdds, OneViewThatSeesItGivesItsOwn) {
  const ViewsOptions options;
  const ViewEvidence blind{-7, 0};
  const ViewEvidence seen{2.5, 0.3};
  EXPECT_DOUBLE_EQ(combined_log_odds(std::vector{seen}, options), 2.5);
  EXPECT_DOUBLE_EQ(combined_log_odds(std::vector{seen, blind, blind}, options), 2.5);
}

TEST(CombinedLogOdds, IndependentViewsMultiplyEvidenceAndCountThePriorOnce) {
  ViewsOptions options;
  options.independence = 1;
  const std::vector<ViewEvidence> views = {{1, 0.6}, {-2, 0.6}, {3, 0.6}};
  const double prior = options.empty_log_odds;
  EXPECT_NEAR(combined_log_odds(views, options), prior + (1 - prior) + (-2 - prior) + (3 - prior),
              1e-12);
}

TEST(CombinedLogOdds, WithoutIndependenceViewsAreAveraged) {
  ViewsOptions options;
  options.independence = 0;
  EXPECT_NEAR(combined_log_odds(std::vector<ViewEvidence>{{1, 0.2}, {4, 0.4}}, options), 3, 1e-12);
}

}  // namespace
}  // namespace bpa
