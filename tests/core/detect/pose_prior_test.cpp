// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/pose_prior.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/detect/stages.hpp"
#include "tests/support/all_stages.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa::detect {
namespace {

constexpr double kSigma = 0.06;  // metres
constexpr double kTurn = 0.3;    // radians

PosePrior prior_at(const std::string& model, const Pose& pose, double sigma_m = kSigma,
                   double sigma_rad = kTurn, double weight = 0.95) {
  PosePrior prior;
  prior.model = model;
  prior.position = PositionPrior{pose.translation, sigma_m * sigma_m * Eigen::Matrix3d::Identity()};
  prior.orientation =
      orientation_uncertainty(pose.rotation, sigma_rad * sigma_rad * Eigen::Matrix3d::Identity());
  prior.weight = weight;
  return prior;
}

ObjectModel thing(SymmetryGroup symmetry = {}) {
  ObjectModel model;
  model.name = "thing";
  model.symmetry = std::move(symmetry);
  return model;
}

Pose somewhere() { return {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.4).normalized(), {0.1, 0, 0.8}}; }

Pose turned(const Pose& pose, const Eigen::Vector3d& by) {
  return {rotation_from_vector(by) * pose.rotation, pose.translation};
}

// The formula from the header, with the Gaussian written out and the Bingham's normaliser of three
// equal concentrations c by Simpson's rule over the angle a of a quaternion from the mode: the
// integral of exp(c sin² a) 4 π sin² a from 0 to π.
double expected_evidence(double distance, double turn, double sigma_m, double sigma_rad,
                         double weight) {
  const double c = -2 / (sigma_rad * sigma_rad + kPlacementSigma_rad * kPlacementSigma_rad);
  constexpr int kSteps = 20000;
  double normaliser = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = std::pow(std::sin(M_PI * i / kSteps), 2);
    normaliser += (i % kSteps == 0 ? 1 : i % 2 ? 4 : 2) * std::exp(c * s) * 4 * M_PI * s;
  }
  normaliser *= M_PI / kSteps / 3;
  const double orientation =
      2 * M_PI * M_PI * std::exp(c * std::pow(std::sin(turn / 2), 2)) / normaliser;
  const double variance = sigma_m * sigma_m + kPlacementSigma_m * kPlacementSigma_m;
  const double position = kBackgroundVolume * std::exp(-distance * distance / (2 * variance)) /
                          std::pow(2 * M_PI * variance, 1.5);
  return std::log(1 - weight + weight * position * orientation);
}

TEST(PosePrior, EvidenceIsTheRatioOfDensities) {
  const ObjectModel model = thing();
  const Pose pose = somewhere();
  // Wide enough to stay within the bounds.
  for (const double weight : {0.2, 0.95, 1.0}) {
    for (const double turn : {0.0, 0.4, 1.5}) {
      for (const double distance : {0.0, 0.1, 0.3}) {
        const PosePrior prior = prior_at("thing", pose, 0.2, 0.8, weight);
        Pose at = turned(pose, turn * Eigen::Vector3d(0.6, 0, -0.8));
        at.translation += distance * Eigen::Vector3d(0, 0.6, 0.8);
        const double expected = expected_evidence(distance, turn, 0.2, 0.8, weight);
        ASSERT_LT(std::abs(expected), kMostPriorEvidence);
        const std::vector<PosePrior> priors{prior};
        EXPECT_NEAR(ModelPriors(priors, model).evidence(at), expected, 1e-5)
            << weight << " " << turn << " " << distance;
      }
    }
  }
}

TEST(PosePrior, EvidenceIsBounded) {
  const ObjectModel model = thing();
  const std::vector<PosePrior> sharp{prior_at("thing", somewhere(), 1e-4, 1e-3, 1)};
  const ModelPriors priors(sharp, model);
  EXPECT_EQ(priors.evidence(somewhere()), kMostPriorEvidence);
  EXPECT_EQ(priors.evidence({}), -kMostPriorEvidence);
  const std::vector<PosePrior> likely{prior_at("thing", somewhere(), 0.01, 0.1, 0.95)};
  EXPECT_NEAR(ModelPriors(likely, model).evidence({}), std::log(0.05), 1e-12);
}

TEST(PosePrior, WhatIsUnknownSaysNothing) {
  const ObjectModel model = thing();
  PosePrior nothing;
  nothing.model = "thing";
  PosePrior other = prior_at("something else", somewhere());
  EXPECT_NEAR(ModelPriors(std::vector{nothing}, model).evidence(somewhere()), 0, 1e-9);
  EXPECT_TRUE(ModelPriors(std::vector{other}, model).empty());
  EXPECT_EQ(ModelPriors(std::vector{other}, model).evidence(somewhere()), 0);
  // The position alone: any orientation is the same.
  PosePrior position = prior_at("thing", somewhere(), 0.2);
  position.orientation = {};
  const ModelPriors priors(std::vector{position}, model);
  EXPECT_NEAR(priors.evidence(somewhere()), priors.evidence(turned(somewhere(), {1, 1, 1})), 1e-9);
}

TEST(PosePrior, SeveralAreOfSeveralInstances) {
  const ObjectModel model = thing();
  const Pose first = somewhere();
  const Pose second{first.rotation, first.translation + Eigen::Vector3d(0.5, 0, 0)};
  const std::vector<PosePrior> both{prior_at("thing", first, 0.2, 0.8, 0.9),
                                    prior_at("thing", second, 0.2, 0.8, 0.6)};
  const double expected = std::log(0.5 * (std::exp(expected_evidence(0, 0, 0.2, 0.8, 0.9)) +
                                          std::exp(expected_evidence(0.5, 0, 0.2, 0.8, 0.6))));
  EXPECT_NEAR(ModelPriors(both, model).evidence(first), expected, 1e-5);
}

TEST(PosePrior, PosesThatLookTheSameAreOne) {
  const Pose half{Eigen::Quaterniond(0, 0, 0, 1), {0.02, 0, 0}};
  const ObjectModel two = thing({{half}, {}});
  const std::vector<PosePrior> prior{prior_at("thing", somewhere(), 0.5, 0.5, 1)};
  const double one = ModelPriors(prior, thing()).evidence(somewhere());
  const ModelPriors priors(prior, two);
  EXPECT_NEAR(priors.evidence(somewhere()), priors.evidence(somewhere() * half), 1e-9);
  // One of two poses has it all, as against each of them having its share of the background.
  EXPECT_NEAR(priors.evidence(somewhere()), one - std::log(2.0), 0.02);

  const ObjectModel round = thing({{}, {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}}});
  const std::vector<PosePrior> sharp{prior_at("thing", somewhere(), 0.7, 0.01, 1)};
  const ModelPriors about(sharp, round);
  for (const double turn : {0.0, 0.017, 1.0, 3.0}) {
    const Pose spun{somewhere().rotation * rotation_from_vector({0, 0, turn}),
                    somewhere().translation};
    EXPECT_NEAR(about.evidence(spun), about.evidence(somewhere()), 1e-6) << turn;
  }
}

TEST(PosePrior, FollowsItsFrame) {
  const ObjectModel model = thing();
  const Pose a_from_b{Eigen::Quaterniond(0.3, 0.8, -0.2, 0.4).normalized(), {0.3, -0.2, 0.1}};
  PosePrior prior = prior_at("thing", somewhere(), 0.3, 0.9);
  prior.position->covariance.diagonal() << 0.2, 0.05, 0.01;
  prior.orientation.concentrations << -9, -4, -1;
  const std::vector<PosePrior> b{prior}, a{transformed(a_from_b, prior)};
  EXPECT_TRUE(validate(a[0], "prior").ok());
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0.2, 0.4)}) {
    Pose pose = turned(somewhere(), by);
    pose.translation += 0.1 * by;
    EXPECT_NEAR(ModelPriors(a, model).evidence(a_from_b * pose),
                ModelPriors(b, model).evidence(pose), 1e-9);
  }
}

struct BadPrior {
  const char* name;
  std::function<void(PosePrior&)> spoil;
  const char* message;
};

class BadPriors : public ::testing::TestWithParam<BadPrior> {};

TEST_P(BadPriors, AreRefusedWithFieldAndRule) {
  PosePrior prior = prior_at("thing", somewhere());
  ASSERT_TRUE(validate(prior, "priors[3]").ok());
  GetParam().spoil(prior);
  const Status status = validate(prior, "priors[3]");
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  EXPECT_EQ(status.message, std::string("priors[3].") + GetParam().message);
}

const BadPrior kBadPriors[] = {
    {"WeightZero", [](PosePrior& p) { p.weight = 0; },
     "weight is 0; it must be above 0 and at most 1"},
    {"WeightAboveOne", [](PosePrior& p) { p.weight = 1.5; },
     "weight is 1.5; it must be above 0 and at most 1"},
    {"WeightNan", [](PosePrior& p) { p.weight = std::nan(""); },
     "weight is nan; it must be above 0 and at most 1"},
    {"MeanInfinite", [](PosePrior& p) { p.position->mean.y() = INFINITY; },
     "position mean is inf; it must be finite"},
    {"CovarianceNan", [](PosePrior& p) { p.position->covariance(1, 2) = std::nan(""); },
     "position covariance is nan; it must be finite"},
    {"CovarianceFlat", [](PosePrior& p) { p.position->covariance(2, 2) = 0; },
     "position covariance is not symmetric and positive definite; it must be"},
    {"CovarianceSkewed", [](PosePrior& p) { p.position->covariance(0, 2) = 1e-3; },
     "position covariance is not symmetric and positive definite; it must be"},
    {"ConcentrationAboveZero", [](PosePrior& p) { p.orientation.concentrations[1] = 2; },
     "orientation concentration is 2; it must be 0 or less"},
    {"ConcentrationInfinite", [](PosePrior& p) { p.orientation.concentrations[0] = -INFINITY; },
     "orientation concentration is -inf; it must be finite"},
    {"AxesSkewed", [](PosePrior& p) { p.orientation.axes.col(1) = p.orientation.axes.col(0); },
     "orientation axes are not three unit quaternions at right angles to one another; they must "
     "be"},
    {"AxesZero", [](PosePrior& p) { p.orientation.axes.setZero(); },
     "orientation axes are not three unit quaternions at right angles to one another; they must "
     "be"},
};

INSTANTIATE_TEST_SUITE_P(All, BadPriors, ::testing::ValuesIn(kBadPriors),
                         [](const auto& test) { return test.param.name; });

// With a scene: an L and a brick on a table.
class PriorsOf : public test::LScene {
 protected:
  // The brick, but with nothing known of its symmetry: four poses look the same.
  static std::shared_ptr<const ObjectModel> ambiguous_brick() {
    auto brick = std::make_shared<ObjectModel>(*brick_);
    brick->symmetry = {};
    return brick;
  }
};

TEST_F(PriorsOf, DecideBetweenPosesThatLookTheSame) {
  const SceneFeatures scene = features_of(everything());
  const auto brick = ambiguous_brick();
  const Pose turned_over = brick_truth_ * Pose{Eigen::Quaterniond(0, 0, 0, 1), {0, 0, 0}};
  std::vector<PosePrior> given = {prior_at("brick", turned_over)};
  const auto candidates =
      test::run_all_stages(Search(scene, *brick, {}, score::default_score_layers(), given));
  ASSERT_FALSE(candidates.empty());
  const PoseError error = pose_error(candidates[0].pose(), turned_over);
  EXPECT_LT(error.position, 0.005);
  EXPECT_LT(error.angle, 0.06);
  // Each score is the image's, which rivals are compared in, and what the prior adds.
  const ModelPriors priors(given, *brick);
  DetectOptions in_full;
  in_full.score.stop_early = false;
  const Search search(scene, *brick, in_full);
  for (const Candidate& c : candidates) {
    EXPECT_EQ(c.prior, priors.evidence(c.pose()));
    Candidate alone = search.scored(c, c.refinement);
    alone.values[score::component("rivals")] = c.values[score::component("rivals")];
    search.apply_layer(alone);
    EXPECT_NEAR(c.score, alone.score + c.prior, 1e-9);
  }
  EXPECT_EQ(to_placement(candidates[0]).components.back().name, "prior");
  EXPECT_EQ(to_placement(candidates[0]).components.back().value, candidates[0].prior);
  // The odds of one pose against the other, at equal fit, are those of the evidence; the prior is
  // so far from the pose that looks the same that only its weight counts there.
  EXPECT_NEAR(priors.evidence(turned_over) - priors.evidence(brick_truth_),
              kMostPriorEvidence - std::log(0.05), 0.01);
}

TEST_F(PriorsOf, WrongOnesDoNotHideAClearObject) {
  const SceneFeatures scene = features_of(everything(), 1);
  Pose elsewhere = l_truth_;
  elsewhere.translation.x() += 0.3;
  std::vector<PosePrior> given = {prior_at("l", elsewhere, 0.02, 0.1)};
  const auto candidates =
      test::run_all_stages(Search(scene, *l_, {}, score::default_score_layers(), given));
  ASSERT_FALSE(candidates.empty());
  const PoseError error = pose_error(candidates[0].pose(), l_truth_, l_->symmetry);
  EXPECT_LT(error.position, 0.005);
  EXPECT_LT(error.angle, 0.06);
  EXPECT_NEAR(candidates[0].prior, std::log(0.05), 1e-6);
  EXPECT_GT(candidates[0].probability, 0.5);
}

TEST_F(PriorsOf, FindWhatFeaturesDoNot) {
  SceneFeatures scene = features_of(everything(), 1);
  scene.sample = {};
  ASSERT_TRUE(test::run_all_stages(Search(scene, *l_)).empty()) << "nothing suggests a pose";
  // Off by what a tracker is off by.
  std::vector<PosePrior> given = {
      prior_at("l", test::disturbed(l_truth_, 0.02, 0.2, 5), 0.02, 0.2)};
  const auto candidates =
      test::run_all_stages(Search(scene, *l_, {}, score::default_score_layers(), given));
  ASSERT_FALSE(candidates.empty());
  const PoseError error = pose_error(candidates[0].pose(), l_truth_, l_->symmetry);
  EXPECT_LT(error.position, 0.005);
  EXPECT_LT(error.angle, 0.06);

  // The position alone, or the orientation alone.
  PosePrior position = given[0], orientation = given[0];
  position.orientation = {};
  orientation.position.reset();
  for (const PosePrior& prior : {position, orientation}) {
    given = {prior};
    DetectOptions options;
    options.sample.draws_per_prior = 1000;
    const auto found =
        test::run_all_stages(Search(scene, *l_, options, score::default_score_layers(), given));
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Candidate& c) {
      return pose_error(c.pose(), l_truth_, l_->symmetry).position < 0.01;
    })) << (prior.position ? "position" : "orientation");
  }
}

TEST_F(PriorsOf, DrawsAreOfTheDistribution) {
  const auto brick = ambiguous_brick();
  PosePrior prior = prior_at("brick", brick_truth_, 0.03, 0.2);
  prior.position->covariance(0, 1) = prior.position->covariance(1, 0) = 0.0004;
  RandomStream random(1, 2);
  const auto poses = ModelPriors(std::vector{prior}, *brick).draw({}, 20000, random);
  ASSERT_EQ(poses.size(), 20000u);
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero(), rotation = Eigen::Matrix3d::Zero();
  for (const Pose& pose : poses) {
    const Eigen::Vector3d d = pose.translation - prior.position->mean;
    const Eigen::Vector3d turn =
        vector_from_rotation(pose.rotation * brick_truth_.rotation.conjugate());
    position += d * d.transpose() / 20000;
    rotation += turn * turn.transpose() / 20000;
  }
  EXPECT_LT((position - prior.position->covariance).norm(), 0.04 * position.norm());
  EXPECT_LT((rotation - 0.04 * Eigen::Matrix3d::Identity()).norm(), 0.06 * rotation.norm());
}

}  // namespace
}  // namespace bpa::detect
