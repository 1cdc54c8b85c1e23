// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/align/anisotropy.hpp"

#include <Eigen/Cholesky>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/align/align_problems.hpp"
#include "tests/core/align/paper_forms.hpp"

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Points seen with `depth` times more noise along the optical axis than across.
struct Problem {
  Pose truth;
  std::vector<OrientedPair> pairs;
  std::vector<Matrix3d> covariances;
};

Problem make_problem(int count, double depth, RandomStream& random) {
  Problem problem;
  problem.truth = random_pose(random);
  for (int i = 0; i < count; ++i) {
    const double across = 0.004;
    const Matrix3d covariance = Vector3d(1, 1, depth * depth).asDiagonal() * (across * across);
    const double sigma = std::sqrt(covariance.trace() / 3);
    OrientedPair pair =
        draw_pair(random_feature(random, -200, 0), problem.truth, 0, -200, 0, random);
    pair.sigma = sigma;
    pair.scene.point += covariance.llt().matrixL() * random_vector(random);
    problem.pairs.push_back(pair);
    problem.covariances.push_back(covariance);
  }
  return problem;
}

TEST(Anisotropy, IsotropicWeightsAreEqual) {
  RandomStream random(1);
  const Problem problem = make_problem(3, 1, random);
  for (const bool known : {true, false}) {
    const Correspondences data{.oriented = problem.pairs, .curvature_sign_known = known};
    const SampledPosterior s = sample_posterior(data, {}, 1000, random);
    EXPECT_NEAR(s.effective_sample_size, 1000, 1e-6);
    // Stated covariances that happen to be isotropic change nothing but the proposal.
    const SampledPosterior stated =
        sample_posterior(data, {.oriented = problem.covariances}, 1000, random);
    EXPECT_GT(stated.effective_sample_size, 700);
  }
}

TEST(Anisotropy, RefinedPoseIsAMaximumAndIsHornsWhereIsotropic) {
  RandomStream random(3);
  for (int i = 0; i < 50; ++i) {
    const Problem problem = make_problem(5, 1, random);
    const Correspondences data{.oriented = problem.pairs, .curvature_sign_known = true};
    const Pose mode = bpa_mode(data).camera_from_object;
    Pose start = mode;
    start.rotation = rotation_from_vector(random_vector(random, 0.1)) * start.rotation;
    start.translation += random_vector(random, 0.02);
    const RefinedPose refined = refine(data, {}, start);
    EXPECT_TRUE(refined.converged);
    EXPECT_LT(rotation_angle(refined.camera_from_object.rotation, mode.rotation), 1e-5);
    EXPECT_LT((refined.camera_from_object.translation - mode.translation).norm(), 1e-6);
    const Matrix6d bingham = posterior(data).covariance();
    EXPECT_LT((refined.covariance - bingham).norm(), 0.1 * bingham.norm());
  }
}

TEST(Anisotropy, WeightsMakeUpForTheProposal) {
  // The mean translation under the true covariances, by samples and from the refined mode.
  RandomStream random(4);
  double worst = 1;
  for (int i = 0; i < 20; ++i) {
    const Problem problem = make_problem(6, 6, random);
    const Correspondences data{.oriented = problem.pairs, .curvature_sign_known = true};
    const Anisotropy anisotropy{.oriented = problem.covariances};
    const int count = 4000;
    const SampledPosterior s = sample_posterior(data, anisotropy, count, random);
    const RefinedPose refined = refine(data, anisotropy, bpa_mode(data).camera_from_object);
    Vector3d mean = Vector3d::Zero();
    for (const WeightedPose& w : s.samples) mean += w.weight * w.camera_from_object.translation;
    const Vector3d difference = mean - refined.camera_from_object.translation;
    const Matrix3d covariance = refined.covariance.topLeftCorner<3, 3>();
    // The mean is not the mode, but near it.
    EXPECT_LT(difference.dot(covariance.inverse() * difference), 0.06);
    worst = std::min(worst, s.effective_sample_size / count);
  }
  std::printf("least effective share of samples at 6:1 noise: %.2f\n", worst);
  EXPECT_GT(worst, 0.3);
}

TEST(Anisotropy, ThePapersSamplerAgreesWithMoreLoss) {
  RandomStream random(5);
  const Problem problem = make_problem(3, 1, random);
  const Correspondences data{.oriented = problem.pairs, .curvature_sign_known = true};
  const int count = 40000;
  const SampledPosterior paper = sample_translation_first(data, count, random);
  const SampledPosterior ours = sample_posterior(data, {}, count, random);
  std::printf("effective share: translation first %.2f, centroid %.2f\n",
              paper.effective_sample_size / count, ours.effective_sample_size / count);
  const auto moments = [](const SampledPosterior& s) {
    Vector3d mean = Vector3d::Zero();
    for (const WeightedPose& w : s.samples) mean += w.weight * w.camera_from_object.translation;
    Matrix3d covariance = Matrix3d::Zero();
    for (const WeightedPose& w : s.samples) {
      const Vector3d d = w.camera_from_object.translation - mean;
      covariance += w.weight * d * d.transpose();
    }
    return std::pair(mean, covariance);
  };
  const auto [mean_a, covariance_a] = moments(paper);
  const auto [mean_b, covariance_b] = moments(ours);
  EXPECT_LT((covariance_a - covariance_b).norm(), 0.06 * covariance_b.norm());
  EXPECT_LT((mean_a - mean_b).norm(), 0.03 * std::sqrt(covariance_b.trace()));
  EXPECT_GT(paper.effective_sample_size, 0.2 * count);
}

}  // namespace
}  // namespace bpa::align
