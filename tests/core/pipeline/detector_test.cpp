// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

// Bit for bit the same, but for the times.
void expect_same(const SceneInterpretations& a, const SceneInterpretations& b) {
  ASSERT_EQ(a.interpretations.size(), b.interpretations.size());
  for (std::size_t k = 0; k < a.interpretations.size(); ++k) {
    const Interpretation& x = a.interpretations[k];
    const Interpretation& y = b.interpretations[k];
    ASSERT_EQ(x.score, y.score);
    ASSERT_EQ(x.probability, y.probability);
    ASSERT_EQ(x.placements.size(), y.placements.size());
    for (std::size_t i = 0; i < x.placements.size(); ++i) {
      const Placement& p = x.placements[i];
      const Placement& q = y.placements[i];
      ASSERT_EQ(p.model, q.model);
      ASSERT_EQ(p.frame_from_object.translation, q.frame_from_object.translation);
      ASSERT_EQ(p.frame_from_object.rotation.coeffs(), q.frame_from_object.rotation.coeffs());
      ASSERT_EQ(p.covariance, q.covariance);
      ASSERT_EQ(p.orientation.concentrations, q.orientation.concentrations);
      ASSERT_EQ(p.score, q.score);
      ASSERT_EQ(p.probability, q.probability);
    }
  }
}

std::vector<std::string> names(const Interpretation& interpretation) {
  std::vector<std::string> out;
  for (const Placement& placement : interpretation.placements) out.push_back(placement.model);
  std::sort(out.begin(), out.end());
  return out;
}

class DetectorOf : public test::LScene {
 protected:
  static void SetUpTestSuite() {
    LScene::SetUpTestSuite();
    auto library = std::make_shared<ModelLibrary>();
    EXPECT_TRUE(library->add(l_).ok());
    EXPECT_TRUE(library->add(brick_).ok());
    library_ = library;
    frame_ = test::render(everything(), test::kinect_camera(), 1, 8).frame;
    frame_.stamp_ns = 1234567890123;
    frame_.frame_id = "kinect_optical";
  }
  static void TearDownTestSuite() {
    library_.reset();
    LScene::TearDownTestSuite();
  }

  static DetectorOptions quick() {  // enough for two objects
    DetectorOptions options;
    options.features.max_references = 200;
    options.detect.refine.max_refined = 10;
    options.scene.annealing_steps = 3000;
    return options;
  }
  static Result<SceneInterpretations> detect(const DetectRequest& request,
                                             const Frame& frame = frame_) {
    return Detector(library_, quick()).detect(frame, request);
  }
  static SceneInterpretations found(const DetectRequest& request, const Frame& frame = frame_) {
    auto result = detect(request, frame);
    EXPECT_TRUE(result.ok()) << result.status().message;
    return result.ok() ? std::move(result).value() : SceneInterpretations{};
  }
  static std::string refusal(const DetectRequest& request) {
    const auto result = detect(request);
    EXPECT_EQ(result.status().code, StatusCode::invalid_argument);
    return result.status().message;
  }

  static inline std::shared_ptr<const ModelLibrary> library_;
  static inline Frame frame_;
};

TEST_F(DetectorOf, FindsBothObjectsWhereTheyAre) {
  const SceneInterpretations result = found({});
  EXPECT_EQ(result.stamp_ns, frame_.stamp_ns);
  EXPECT_EQ(result.frame_id, frame_.frame_id);
  EXPECT_FALSE(result.budget_exhausted);
  EXPECT_GE(result.timings.size(), 4u);
  ASSERT_FALSE(result.interpretations.empty());
  EXPECT_LE(result.interpretations.size(), 20u);
  const Interpretation& best = result.interpretations[0];
  EXPECT_EQ(names(best), (std::vector<std::string>{"brick", "l"}));
  for (const Placement& placement : best.placements) {
    const bool is_l = placement.model == "l";
    const PoseError error = pose_error(placement.frame_from_object, is_l ? l_truth_ : brick_truth_,
                                       (is_l ? l_ : brick_)->symmetry);
    EXPECT_LT(error.position, 0.005);
    EXPECT_LT(error.angle, 0.06);
    EXPECT_GT(placement.probability, 0.5);
  }
}

TEST_F(DetectorOf, GivesTheSameAnswerForAnyThreads) {
  DetectRequest request;
  request.num_threads = 1;
  const SceneInterpretations one = found(request);
  for (const int threads : {2, 8}) {
    request.num_threads = threads;
    expect_same(one, found(request));
  }
}

TEST_F(DetectorOf, LaterRoundsFindWhatTheFirstMisses) {
  DetectorOptions options = quick();
  options.features.max_references = 2;
  options.features.round_keypoints = 1;
  const auto found_in = [&](int rounds) {
    options.rounds.max_rounds = rounds;
    const auto result = Detector(library_, options).detect(frame_, {});
    EXPECT_TRUE(result.ok()) << result.status().message;
    return names(result->interpretations.at(0));
  };
  EXPECT_LT(found_in(1).size(), 2u);
  EXPECT_EQ(found_in(40), (std::vector<std::string>{"brick", "l"}));
}

TEST_F(DetectorOf, TellsAfterEachRoundWhatIsFoundSoFarAndAnswersTheSame) {
  std::vector<SceneInterpretations> so_far;
  DetectRequest request;
  request.on_round = [&](const SceneInterpretations& found) { so_far.push_back(found); };
  const SceneInterpretations whole = found(request);
  expect_same(found({}), whole);
  EXPECT_FALSE(whole.partial);
  ASSERT_EQ(static_cast<long>(so_far.size()), whole.effort.rounds);
  for (const SceneInterpretations& part : so_far) {
    EXPECT_TRUE(part.partial);
    EXPECT_EQ(part.stamp_ns, frame_.stamp_ns);
    EXPECT_EQ(part.sensor, whole.sensor);
  }
  const Interpretation& last = so_far.back().interpretations.at(0);
  ASSERT_EQ(names(last), (std::vector<std::string>{"brick", "l"}));
  for (const Placement& placement : last.placements) {
    if (placement.model != "brick") continue;
    const PoseError error = pose_error(placement.frame_from_object, brick_truth_, brick_->symmetry);
    EXPECT_LT(error.position, 0.005);
    EXPECT_LT(error.angle, 0.06);
  }
}

TEST_F(DetectorOf, FollowsAStandingSceneWithLessWork) {
  const SceneInterpretations first = found({});
  Frame second = test::render(everything(), test::kinect_camera(), 2, 8).frame;
  const SceneInterpretations alone = found({}, second);
  DetectRequest request;
  request.expected = expected_after(first);
  ASSERT_EQ(request.expected.size(), 2u);
  const SceneInterpretations followed = found(request, second);
  EXPECT_EQ(names(followed.interpretations[0]), (std::vector<std::string>{"brick", "l"}));
  constexpr double kFraction = 0.7;  // of the work; measured: 0.54
  EXPECT_LT(static_cast<double>(followed.effort.sampled_poses),
            kFraction * static_cast<double>(alone.effort.sampled_poses));
  for (const Placement& placement : followed.interpretations[0].placements) {
    const bool is_l = placement.model == "l";
    const PoseError error = pose_error(placement.frame_from_object, is_l ? l_truth_ : brick_truth_,
                                       (is_l ? l_ : brick_)->symmetry);
    EXPECT_LT(error.position, 0.005);
  }
}

TEST_F(DetectorOf, WhatIsExpectedButGoneIsNotReported) {
  DetectRequest request;
  request.expected = expected_after(found({}));
  request.expected.push_back({"no such model", {}});
  const Frame frame = test::render(table_only(), test::kinect_camera(), 1, 8).frame;
  EXPECT_TRUE(found(request, frame).interpretations[0].placements.empty());
  for (ExpectedPlacement& expected : request.expected) {
    expected.frame_from_object.translation.x() += 0.2;  // where they were before they moved
  }
  EXPECT_EQ(names(found(request).interpretations[0]), (std::vector<std::string>{"brick", "l"}));
}

TEST_F(DetectorOf, LooksOnlyForTheModelsNamed) {
  DetectRequest request;
  request.models = {"brick"};
  const SceneInterpretations result = found(request);
  ASSERT_FALSE(result.interpretations[0].placements.empty());
  const Pose& best = result.interpretations[0].placements[0].frame_from_object;
  EXPECT_LT(pose_error(best, brick_truth_, brick_->symmetry).position, 0.01) << "the likeliest";
  for (const Interpretation& interpretation : result.interpretations) {
    for (const Placement& placement : interpretation.placements) {
      EXPECT_EQ(placement.model, "brick");
    }
  }
  request.models = {"brick", "brick"};
  expect_same(result, found(request));
}

TEST_F(DetectorOf, ReturnsNoMoreThanTopK) {
  DetectRequest request;
  const SceneInterpretations many = found(request);
  ASSERT_GT(many.interpretations.size(), 2u);
  request.top_k = 2;
  const SceneInterpretations two = found(request);
  ASSERT_EQ(two.interpretations.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(two.interpretations[k].score, many.interpretations[k].score);
  }
}

TEST_F(DetectorOf, ProbabilitiesOfWhatIsReturnedSumToOne) {
  DetectRequest request;
  for (request.top_k = 1; request.top_k <= 2; ++request.top_k) {
    double sum = 0;
    for (const Interpretation& interpretation : found(request).interpretations) {
      sum += interpretation.probability;
    }
    EXPECT_NEAR(sum, 1, 1e-9) << request.top_k;
  }
}

TEST_F(DetectorOf, RefusesRequestsThatBreakARule) {
  DetectRequest request;
  for (const int top_k : {0, -1, 101}) {
    request.top_k = top_k;
    EXPECT_EQ(refusal(request),
              "top_k is " + std::to_string(top_k) + "; it must be between 1 and 100");
  }
  request = {};
  for (const double budget : {-1.0, std::nan("")}) {
    request.budget_ms = budget;
    EXPECT_NE(refusal(request).find("it must be 0 (no limit) or more"), std::string::npos);
  }
}

TEST_F(DetectorOf, NamesTheModelItDoesNotKnow) {
  DetectRequest request;
  request.models = {"brick", "teapot"};
  const auto result = detect(request);
  EXPECT_EQ(result.status().code, StatusCode::not_found);
  EXPECT_EQ(result.status().message, "the library holds no model named \"teapot\"");
}

TEST_F(DetectorOf, RefusesAnEmptyLibrary) {
  const auto result = Detector(std::make_shared<ModelLibrary>(), {}).detect(frame_);
  EXPECT_EQ(result.status().code, StatusCode::invalid_argument);
  EXPECT_EQ(result.status().message, "the model library is empty; add models with 'bpa model'");
}

TEST_F(DetectorOf, RefusesABadFrame) {
  Frame frame = frame_;
  frame.depth.pop_back();
  EXPECT_EQ(detect({}, frame).status().code, StatusCode::invalid_argument);
  EXPECT_FALSE(detect({}, Frame{}).ok());
}

TEST_F(DetectorOf, SaysWhenTheBudgetIsUsedUp) {
  DetectRequest request;
  request.budget_ms = 1e-6;
  const SceneInterpretations late = found(request);
  EXPECT_TRUE(late.budget_exhausted);
  ASSERT_FALSE(late.interpretations.empty());
  EXPECT_TRUE(late.interpretations[0].placements.empty());
  request.budget_ms = 1e9;
  const SceneInterpretations in_time = found(request);
  EXPECT_FALSE(in_time.budget_exhausted);
  expect_same(in_time, found({}));
}

TEST_F(DetectorOf, AnEmptySceneIsAResult) {
  const Frame frame = test::render(table_only(), test::kinect_camera(), 1, 8).frame;
  const SceneInterpretations result = found({}, frame);
  ASSERT_FALSE(result.interpretations.empty());
  EXPECT_TRUE(result.interpretations[0].placements.empty());
}

TEST_F(DetectorOf, SearchesOnlyTheRegionOfInterest) {
  // The image's part about the brick; the mask does the same.
  const Eigen::Vector2d middle = frame_.camera.project(brick_truth_.translation);
  Frame by_roi = frame_;
  by_roi.roi = {static_cast<int>(middle.x()) / 2 * 2 - 70,
                static_cast<int>(middle.y()) / 2 * 2 - 70, 140, 140};
  Frame by_mask = frame_;
  by_mask.mask.assign(frame_.depth.size(), 0);
  for (int v = 0; v < by_roi.roi.height; ++v) {
    for (int u = 0; u < by_roi.roi.width; ++u) {
      by_mask.mask[static_cast<std::size_t>((v + by_roi.roi.y) * frame_.camera.width + u +
                                            by_roi.roi.x)] = 1;
    }
  }
  const SceneInterpretations result = found({}, by_roi);
  EXPECT_EQ(names(result.interpretations[0]), std::vector<std::string>{"brick"});
  expect_same(result, found({}, by_mask));
}

TEST_F(DetectorOf, WithAnyOneThingLeftOutItsAnswerIsValidAndHoldsBothObjects) {
  const SceneInterpretations with_all = found({});
  using Change = void (*)(detect::DetectOptions&);
  for (const Change leave_out :
       {Change([](detect::DetectOptions& o) { o.align.use_orientation = false; }),
        Change([](detect::DetectOptions& o) { o.align.use_segments = false; }),
        Change([](detect::DetectOptions& o) { o.align.use_edges = false; }),
        Change([](detect::DetectOptions& o) { o.climb.max_climbed = 0; }),
        Change([](detect::DetectOptions& o) { o.score.use_round_three = false; })}) {
    DetectorOptions options = quick();
    leave_out(options.detect);
    const auto result = Detector(library_, options).detect(frame_);
    ASSERT_TRUE(result.ok()) << result.status().message;
    ASSERT_FALSE(result->interpretations.empty());
    EXPECT_TRUE(result->effort != with_all.effort ||
                result->interpretations[0].score != with_all.interpretations.at(0).score)
        << "nothing was left out";
    std::set<std::string> right;
    for (const Interpretation& interpretation : result->interpretations) {
      for (const Placement& placement : interpretation.placements) {
        const bool is_l = placement.model == "l";
        const PoseError error =
            pose_error(placement.frame_from_object, is_l ? l_truth_ : brick_truth_,
                       (is_l ? l_ : brick_)->symmetry);
        if (error.position < 0.01 && error.angle < 0.12) right.insert(placement.model);
        EXPECT_TRUE(placement.probability > 0 && placement.probability <= 1);
        EXPECT_TRUE(placement.covariance.allFinite());
        for (const ScoreComponent& component : placement.components) {
          EXPECT_TRUE(std::isfinite(component.value)) << component.name;
        }
      }
    }
    EXPECT_EQ(right, (std::set<std::string>{"brick", "l"}));
  }
}

class DetectorOfPainted : public DetectorOf {
 protected:
  /// Stripes of two colours: edges of the image alone.
  static Frame painted(const std::array<std::uint8_t, 3>& odd,
                       const std::array<std::uint8_t, 3>& even) {
    Frame frame = frame_;
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      const bool is_odd = i % static_cast<std::size_t>(frame.camera.width) / 16 % 2 == 1;
      frame.color.insert(frame.color.end(), (is_odd ? odd : even).begin(),
                         (is_odd ? odd : even).end());
    }
    return frame;
  }
};

TEST_F(DetectorOfPainted, WithoutColoursItIsAsIfTheFrameHadNone) {
  const Frame frame = painted({220, 40, 60}, {40, 60, 220});
  DetectorOptions options = quick();
  options.features.use_color = false;
  const auto ignored = Detector(library_, options).detect(frame);
  ASSERT_TRUE(ignored.ok()) << ignored.status().message;
  expect_same(*ignored, found({}));
  EXPECT_NE(found({}, frame).interpretations.at(0).score, ignored->interpretations.at(0).score);
}

TEST_F(DetectorOfPainted, ImagesOfOneColourAreNoEvidenceAndGreyOnesShowOutlines) {
  const auto why = [](const SceneInterpretations& result, const char* setting) {
    return std::ranges::find(result.plan, setting, &PlanEntry::name)->reason;
  };
  const auto shows_outline = [](const SceneInterpretations& result) {
    const auto& components = result.interpretations.at(0).placements.at(0).components;
    return std::ranges::count(components, "silhouette", &ScoreComponent::name) > 0;
  };
  const SceneInterpretations without = found({});
  EXPECT_EQ(why(without, "features.use_color"), "the frame has no colour image");
  EXPECT_EQ(why(without, "features.use_outline"), "the frame has no colour image");
  const SceneInterpretations blank = found({}, painted({180, 40, 30}, {180, 40, 30}));
  expect_same(blank, without);
  EXPECT_EQ(why(blank, "features.use_outline"), "the colour image is of one colour");
  const SceneInterpretations grey = found({}, painted({220, 220, 220}, {40, 43, 38}));
  EXPECT_EQ(why(grey, "features.use_color"), "the colour image is grey, or of one hue");
  EXPECT_EQ(why(grey, "features.use_outline"), "default");
  EXPECT_FALSE(shows_outline(without));
  EXPECT_TRUE(shows_outline(grey));
  EXPECT_EQ(why(found({}, painted({220, 40, 60}, {40, 60, 220})), "features.use_color"), "default");
}

// Where hypotheses come from: nothing that is looked at outside is found, nor in the picture's rest
// a reason for anything inside.
TEST_F(DetectorOf, RegionAndMaskRestrictWhereHypothesesComeFrom) {
  const Eigen::Vector2d middle = frame_.camera.project(brick_truth_.translation);
  Frame odd = frame_;  // cuts the blocks of the reduced image
  odd.roi = {static_cast<int>(middle.x()) / 2 * 2 - 71, static_cast<int>(middle.y()) / 2 * 2 - 71,
             141, 141};
  FrameTrace trace;
  ASSERT_TRUE(Detector(library_, {}).detect(odd, {}, &trace).ok());
  ASSERT_GT(trace.scene.surface.size(), 50u);
  for (const PointCloud* cloud : {&trace.scene.surface, &trace.scene.coarse}) {
    for (const Eigen::Vector3f& p : cloud->points) {
      const Eigen::Vector2d pixel = frame_.camera.project(p.cast<double>());
      EXPECT_GE(pixel.x(), odd.roi.x - 1.5);
      EXPECT_GE(pixel.y(), odd.roi.y - 1.5);
      EXPECT_LE(pixel.x(), odd.roi.x + odd.roi.width + 0.5);
      EXPECT_LE(pixel.y(), odd.roi.y + odd.roi.height + 0.5);
    }
  }
}

PosePrior prior_of(const std::string& model, const Pose& pose) {
  PosePrior prior;
  prior.model = model;
  prior.position = PositionPrior{pose.translation, 4e-4 * Eigen::Matrix3d::Identity()};
  prior.orientation = orientation_uncertainty(pose.rotation, 0.01 * Eigen::Matrix3d::Identity());
  return prior;
}

TEST_F(DetectorOf, TakesPriorsIntoAccount) {
  DetectRequest request;
  const SceneInterpretations without = found(request);
  request.priors = {prior_of("brick", brick_truth_)};
  const SceneInterpretations with = found(request);
  const auto of_brick = [](const SceneInterpretations& result) {
    for (const Placement& p : result.interpretations[0].placements) {
      if (p.model == "brick") return p;
    }
    return Placement{};
  };
  ASSERT_EQ(of_brick(with).model, "brick");
  EXPECT_GT(of_brick(with).probability, of_brick(without).probability);
  EXPECT_EQ(of_brick(with).components.back().name, "prior");
  EXPECT_EQ(of_brick(with).components.back().value, detect::kMostPriorEvidence);
  EXPECT_NE(of_brick(without).components.back().name, "prior");
  // The other model has nothing to do with it.
  EXPECT_EQ(names(with.interpretations[0]), (std::vector<std::string>{"brick", "l"}));
  request.num_threads = 1;
  expect_same(with, found(request));
}

TEST_F(DetectorOf, RefusesBadPriors) {
  DetectRequest request;
  request.priors = {prior_of("brick", brick_truth_), prior_of("brick", brick_truth_)};
  request.priors[1].weight = 2;
  EXPECT_EQ(refusal(request), "priors[1].weight is 2; it must be above 0 and at most 1");
  request.priors[1] = prior_of("teapot", brick_truth_);
  const auto unknown = detect(request);
  EXPECT_EQ(unknown.status().code, StatusCode::not_found);
  EXPECT_EQ(unknown.status().message, "priors[1]: the library holds no model named \"teapot\"");
}

TEST_F(DetectorOf, InvalidDepthIsLikeNone) {
  Frame zeros = frame_;
  Frame nans = frame_;
  for (std::size_t i = 0; i < frame_.depth.size(); i += 7) {
    zeros.depth[i] = 0;
    nans.depth[i] = std::nanf("");
  }
  expect_same(found({}, zeros), found({}, nans));
}

}  // namespace
}  // namespace bpa
