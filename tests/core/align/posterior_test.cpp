// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/posterior.hpp"

#include <Eigen/Eigenvalues>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/align/align_problems.hpp"
#include "tests/core/align/paper_forms.hpp"

namespace bpa::align {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<OrientedPair> draw_pairs(int count, const Pose& truth, double sigma, double lambda3,
                                     RandomStream& random) {
  std::vector<OrientedPair> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back(
        draw_pair(random_feature(random, -200, lambda3), truth, sigma, -200, lambda3, random));
  }
  return pairs;
}

TEST(PositionBingham, IsHornsMatrixOfOnePair) {
  RandomStream random(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d x = random_vector(random, 0.1), y = random_vector(random, 0.1);
    const double sigma = random.uniform(0.01, 0.1);
    const Bingham claim = position_bingham(x, y, sigma);
    for (int k = 0; k < 5; ++k) {
      const Quaterniond q = random_rotation(random), p = random_rotation(random);
      const double difference = (y.dot(q * x) - y.dot(p * x)) / (sigma * sigma);
      EXPECT_NEAR(claim.log_density(q) - claim.log_density(p), difference,
                  1e-9 * (1 + std::abs(difference)));
      // And so the law of cosines has its 2: -d² / 2 σ² with d² = a² + b² - 2 a b cos θ.
      const double squares = (q * x - y).squaredNorm() - (p * x - y).squaredNorm();
      EXPECT_NEAR(difference, -0.5 * squares / (sigma * sigma), 1e-9 * (1 + std::abs(difference)));
    }
  }
}

TEST(ConditionalOrientation, IsTheJointDensityAtThatTranslation) {
  RandomStream random(2);
  for (int i = 0; i < 50; ++i) {
    const Pose truth = random_pose(random);
    const std::vector<OrientedPair> pairs = draw_pairs(4, truth, 0.02, -20, random);
    const Bingham prior = Bingham::about(random_rotation(random), {-3, -2, -1});
    const Correspondences data{
        .oriented = pairs, .orientation_prior = &prior, .curvature_sign_known = true};
    const Posterior joint = posterior(data);
    const Vector3d t = truth.translation + random_vector(random, 0.02);
    const Bingham conditional = conditional_orientation(data, t);
    const Quaterniond p = random_rotation(random);
    for (int k = 0; k < 5; ++k) {
      const Quaterniond q = random_rotation(random);
      const double expected = joint.log_density({q, t}) - joint.log_density({p, t});
      EXPECT_NEAR(conditional.log_density(q) - conditional.log_density(p), expected,
                  1e-8 * (1 + std::abs(expected)));
    }
  }
}

TEST(Posterior, ItsHighestDensityIsTheMode) {
  RandomStream random(3);
  for (int i = 0; i < 50; ++i) {
    const std::vector<OrientedPair> pairs =
        draw_pairs(1 + random.index(8), random_pose(random), 0.01, -30, random);
    const Posterior p = posterior({.oriented = pairs, .curvature_sign_known = true});
    const double best = p.log_density(p.map.camera_from_object);
    for (int k = 0; k < 200; ++k) EXPECT_LE(p.log_density(p.sample(random)), best + 1e-9);
  }
}

TEST(Posterior, OneOpenSignIsTwoEqualHypotheses) {
  RandomStream random(4);
  const std::vector<OrientedPair> pairs = draw_pairs(1, random_pose(random), 0.01, -60, random);
  const Posterior p = posterior({.oriented = pairs});
  ASSERT_EQ(p.orientation.components.size(), 2U);
  EXPECT_NEAR(p.orientation.components[0].weight, 0.5, 1e-12);
  const Quaterniond a = p.orientation.components[0].bingham.mode();
  const Quaterniond b = p.orientation.components[1].bingham.mode();
  EXPECT_NEAR(rotation_angle(a, b), M_PI, 1e-9);
  // More pairs decide it.
  const std::vector<OrientedPair> ten = draw_pairs(10, random_pose(random), 0.003, -60, random);
  EXPECT_GT(posterior({.oriented = ten}).orientation.components[0].weight, 0.999);
}

TEST(Posterior, MixtureIsTheExactSumOverSigns) {
  RandomStream random(5);
  for (int i = 0; i < 20; ++i) {
    const int count = 4;
    const std::vector<OrientedPair> pairs =
        draw_pairs(count, random_pose(random), 0.05, -6, random);
    const Posterior p = posterior({.oriented = pairs}, {.smallest_weight = 0});
    EXPECT_EQ(p.orientation.components.size(), 16U);
    // Up to a constant: the product over pairs of the mean over signs.
    const auto direct = [&](const Quaterniond& q) {
      double sum = 0;
      for (const OrientedPair& pair : pairs) {
        const FeatureConcentration c = compose(pair.model, pair.scene);
        const Quaterniond e = pair.scene.orientation.conjugate() * q * pair.model.orientation;
        sum += c.kappa * (e.y() * e.y() + e.z() * e.z()) +
               std::log(0.5 * std::exp(c.lambda3 * e.x() * e.x()) +
                        0.5 * std::exp(c.lambda3 * e.w() * e.w()));
        const Vector3d x = pair.model.point - p.model_centroid;
        const Vector3d y = pair.scene.point - p.scene_centroid;
        sum += y.dot(q * x) / (pair.sigma * pair.sigma);
      }
      return sum;
    };
    const Quaterniond reference = random_rotation(random);
    for (int k = 0; k < 20; ++k) {
      const Quaterniond q = random_rotation(random);
      const double expected = direct(q) - direct(reference);
      EXPECT_NEAR(p.orientation.log_density(q) - p.orientation.log_density(reference), expected,
                  1e-8 * (1 + std::abs(expected)));
    }
  }
}

TEST(Posterior, CovarianceIsThatOfTheSamples) {
  RandomStream random(6);
  for (int count : {2, 3, 10}) {
    const std::vector<OrientedPair> pairs =
        draw_pairs(count, random_pose(random), 0.004, -200, random);
    const Posterior p = posterior({.oriented = pairs, .curvature_sign_known = true});
    const Pose mode = p.map.camera_from_object;
    const Matrix6d covariance = p.covariance();
    Matrix6d sum = Matrix6d::Zero();
    const int samples = 20000;
    for (int i = 0; i < samples; ++i) {
      const Pose pose = p.sample(random);
      Eigen::Matrix<double, 6, 1> d;
      d << pose.translation - mode.translation,
          vector_from_rotation(pose.rotation * mode.rotation.conjugate());
      sum += d * d.transpose() / samples;
    }
    const Eigen::Matrix<double, 6, 1> deviation = covariance.diagonal().cwiseSqrt();
    const Matrix6d scaled = deviation.cwiseInverse().asDiagonal() * (sum - covariance) *
                            deviation.cwiseInverse().asDiagonal();
    EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 0.06) << scaled;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(covariance).eigenvalues()[0], 0);
  }
}

TEST(Posterior, CovarianceIsFiniteWithoutAnyInformation) {
  const Matrix6d none = posterior({}).covariance();
  EXPECT_TRUE(none.allFinite());
  EXPECT_LT(none.diagonal().maxCoeff(), M_PI * M_PI);
}

TEST(Posterior, PriorsMultiplyIn) {
  RandomStream random(7);
  const Pose truth = random_pose(random);
  const std::vector<OrientedPair> pairs = draw_pairs(1, truth, 0.01, 0, random);
  const Bingham orientation = Bingham::about(truth.rotation, {-1e6, -1e6, -1e6});
  const PositionPrior position{truth.translation, 1e-10 * Eigen::Matrix3d::Identity()};
  const PoseEstimate mode =
      bpa_mode({.oriented = pairs, .orientation_prior = &orientation, .position_prior = &position});
  EXPECT_LT(rotation_angle(mode.camera_from_object.rotation, truth.rotation), 0.01);
  EXPECT_LT((mode.camera_from_object.translation - truth.translation).norm(), 1e-4);
  const PoseEstimate alone =
      bpa_mode({.orientation_prior = &orientation, .position_prior = &position});
  EXPECT_LT((alone.camera_from_object.translation - truth.translation).norm(), 1e-12);
  EXPECT_LT(rotation_angle(alone.camera_from_object.rotation, truth.rotation), 1e-9);
}

}  // namespace
}  // namespace bpa::align
