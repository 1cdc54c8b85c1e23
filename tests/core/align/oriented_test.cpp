// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "core/align/align.hpp"
#include "core/align/moments.hpp"
#include "core/bingham/normalizer.hpp"
#include "tests/core/align/align_problems.hpp"

namespace bpa::align {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The log likelihood of a pose, straight from the definitions.
double log_likelihood(const std::vector<OrientedPair>& pairs, const Pose& pose,
                      const std::vector<bool>& reversed) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const OrientedPair& pair = pairs[i];
    const double d = (pose * pair.model.point - pair.scene.point).norm();
    sum -= 0.5 * d * d / (pair.sigma * pair.sigma);
    const Quaterniond scene =
        reversed[i] ? reversed_curvature(pair.scene.orientation) : pair.scene.orientation;
    const Quaterniond e = scene.conjugate() * pose.rotation * pair.model.orientation;
    const FeatureConcentration c = compose(pair.model, pair.scene);
    sum += c.lambda3 * e.x() * e.x() + c.kappa * (e.y() * e.y() + e.z() * e.z());
  }
  return sum;
}

std::vector<OrientedPair> make_pairs(int count, double noise, RandomStream& random) {
  const Pose truth = random_pose(random);
  std::vector<OrientedPair> pairs;
  for (int i = 0; i < count; ++i) {
    const double lambda3 = random.uniform() < 0.3 ? 0 : -std::exp(random.uniform(0, 4));
    const OrientedPoint model = random_feature(random, -100, lambda3);
    OrientedPair pair = draw_pair(model, truth, noise, -80, lambda3, random);
    if (random.uniform() < 0.5) pair.scene.orientation = reversed_curvature(pair.scene.orientation);
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(OrientedPoint, FrameAndReversal) {
  RandomStream random(5);
  for (int i = 0; i < 100; ++i) {
    const Vector3d n = random_vector(random).normalized();
    const Vector3d p = random_vector(random);
    const Quaterniond q = feature_orientation(n, p);
    const Eigen::Matrix3d r = q.toRotationMatrix();
    EXPECT_LT((r.col(0) - n).norm(), 1e-12);
    EXPECT_GT(r.col(1).dot(p), 0);
    EXPECT_NEAR(r.col(2).dot(p), 0, 1e-12);
    const Eigen::Matrix3d reversed = reversed_curvature(q).toRotationMatrix();
    EXPECT_LT((reversed.col(0) - n).norm(), 1e-12);
    EXPECT_LT((reversed.col(1) + r.col(1)).norm(), 1e-12);
    EXPECT_LT((reversed.col(2) + r.col(2)).norm(), 1e-12);
    for (const Vector3d& bad : {n, Vector3d(Vector3d::Zero()), Vector3d(Vector3d::Constant(NAN))}) {
      const Quaterniond fallback = feature_orientation(n, bad);
      EXPECT_LT((fallback * Vector3d::UnitX() - n).norm(), 1e-12);
    }
  }
}

TEST(OrientedPoint, CurvatureConcentration) {
  EXPECT_EQ(curvature_concentration(1, 1), 0);
  EXPECT_DOUBLE_EQ(curvature_concentration(3, 1), -20);
  EXPECT_EQ(curvature_concentration(1000, 1), -100);
  EXPECT_EQ(curvature_concentration(1, 0), -100);
  EXPECT_EQ(curvature_concentration(0, 0), 0);
  EXPECT_EQ(curvature_concentration(NAN, NAN), 0);
}

TEST(OrientedPoint, FeatureBinghamHasThePapersAxes) {
  RandomStream random(6);
  const OrientedPoint feature = random_feature(random, -100, -30);
  const Bingham bingham = feature_bingham(feature);
  EXPECT_LT(rotation_angle(bingham.mode(), feature.orientation), 1e-12);
  EXPECT_LT((bingham.concentrations() - Eigen::Vector4d(0, -30, -100, -100)).norm(), 1e-12);
  const Eigen::Vector4d v3 = bingham.axes().col(1);
  EXPECT_NEAR(std::abs(v3.dot(to_wxyz(reversed_curvature(feature.orientation)))), 1, 1e-12);
}

// The distribution of the inverse rotation.
Bingham inverse(const Bingham& bingham) {
  const Eigen::Vector4d conjugate(1, -1, -1, -1);
  return Bingham::from_exponent(conjugate.asDiagonal() * bingham.exponent() *
                                conjugate.asDiagonal());
}

// E[(a ∘ b)(a ∘ b)ᵀ] of independent a and b. It is quadratic in a, so a's scatter, axis by axis, is
// all that matters.
Eigen::Matrix4d scatter_of_product(const Bingham& a, const Bingham& b) {
  const Eigen::Vector4d tau = bingham_normalizer(a.concentrations()).gradient;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector4d v = a.axes().col(i);
    const Eigen::Matrix4d left = left_product({v[0], v[1], v[2], v[3]});
    scatter += tau[i] * left * b.scatter() * left.transpose();
  }
  return scatter;
}

TEST(Compose, IsNearTheExactSecondMoments) {
  double worst = 0;
  for (double kappa_a : {-10.0, -100.0, -1e3}) {
    for (double kappa_b : {-30.0, -100.0, -1e4}) {
      for (double share_a : {0.0, 0.01, 0.1, 0.5, 1.0}) {
        for (double share_b : {0.0, 0.03, 0.3, 1.0}) {
          OrientedPoint a, b;
          a.kappa = kappa_a, a.lambda3 = share_a * kappa_a;
          b.kappa = kappa_b, b.lambda3 = share_b * kappa_b;
          const FeatureConcentration ours = compose(a, b);
          // Compared by what they say about the spread: E[ex²] and E[ey²].
          const Eigen::Vector4d tau =
              scatter_of_product(feature_bingham(a), inverse(feature_bingham(b))).diagonal();
          const Eigen::Vector4d our_tau =
              bingham_normalizer({0, ours.lambda3, ours.kappa, ours.kappa}).gradient;
          worst = std::max(worst, std::abs(our_tau[1] / tau[1] - 1));
          worst = std::max(worst, std::abs(our_tau[2] / tau[2] - 1));
        }
      }
    }
  }
  std::printf("second moments within %.1f %%\n", 100 * worst);
  EXPECT_LT(worst, 0.15);
}

TEST(Moments, SayTheLogLikelihoodOfAnyPose) {
  RandomStream random(7);
  for (int i = 0; i < 200; ++i) {
    const std::vector<OrientedPair> pairs = make_pairs(1 + random.index(40), 0.01, random);
    const Correspondences data{.oriented = pairs, .curvature_sign_known = true};
    CurvatureTerms curvature;
    Moments moments = accumulate(data, curvature);
    curvature.for_each(data, [&](const CurvatureTerm& t) { moments.attitude += t.attitude; });
    const Pose pose = random_pose(random);
    const Eigen::Vector4d q = to_wxyz(pose.rotation);
    const double horn = q.dot(horn_matrix(moments.attitude) * q);
    EXPECT_NEAR(horn, (pose.matrix() * moments.attitude).trace(), 1e-10 * (1 + std::abs(horn)));
    const double ours = moments.constant + horn -
                        0.5 * moments.weight *
                            (pose * moments.model_centroid - moments.scene_centroid).squaredNorm();
    const double direct = log_likelihood(pairs, pose, std::vector<bool>(pairs.size(), false));
    EXPECT_NEAR(ours, direct, 1e-9 * std::abs(direct));
  }
}

TEST(BpaMode, IsTheBestOverAllSigns) {
  RandomStream random(8);
  int agreed = 0, problems = 0;
  for (int i = 0; i < 1500; ++i) {
    const int count = 1 + random.index(5);
    const double noise = i % 2 == 0 ? 0.003 : 0.03;  // Half of them leave much to the signs.
    const std::vector<OrientedPair> pairs = make_pairs(count, noise, random);
    const PoseEstimate ours = bpa_mode({.oriented = pairs});
    double best = -INFINITY;
    for (int mask = 0; mask < (1 << count); ++mask) {
      std::vector<OrientedPair> with_signs = pairs;
      std::vector<bool> reversed(pairs.size());
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        reversed[k] = (mask >> k) % 2 == 1;
        if (reversed[k]) {
          with_signs[k].scene.orientation = reversed_curvature(pairs[k].scene.orientation);
        }
      }
      const PoseEstimate one = bpa_mode({.oriented = with_signs, .curvature_sign_known = true});
      EXPECT_NEAR(one.log_score, log_likelihood(pairs, one.camera_from_object, reversed),
                  1e-9 * (1 + std::abs(one.log_score)));
      best = std::max(best, one.log_score);
    }
    EXPECT_LE(ours.log_score, best + 1e-9);
    ++problems;
    if (ours.log_score > best - 1e-6) ++agreed;
  }
  std::printf("best of all signs found in %d of %d problems\n", agreed, problems);
  EXPECT_GT(agreed, 0.98 * problems);
}

TEST(BpaMode, NoNearbyPoseIsBetter) {
  RandomStream random(9);
  for (int i = 0; i < 200; ++i) {
    const std::vector<OrientedPair> pairs = make_pairs(2 + random.index(9), 0.005, random);
    const std::vector<bool> as_given(pairs.size(), false);
    const PoseEstimate mode = bpa_mode({.oriented = pairs, .curvature_sign_known = true});
    const double best = log_likelihood(pairs, mode.camera_from_object, as_given);
    for (int k = 0; k < 20; ++k) {
      Pose pose = mode.camera_from_object;
      const Vector3d turn = random_vector(random, 1e-3);
      pose.rotation = rotation_from_vector(turn) * pose.rotation;
      pose.translation += random_vector(random, 1e-4);
      EXPECT_LT(log_likelihood(pairs, pose, as_given), best + 1e-9);
    }
  }
}

TEST(BpaSampleOne, HitsThePointAndTheNormal) {
  RandomStream random(10);
  const Pose truth = random_pose(random);
  const OrientedPoint model = random_feature(random, -100, -40);
  OrientedPair pair = draw_pair(model, truth, 0.004, -100, -60, random);
  const FeatureConcentration c = compose(pair.model, pair.scene);
  const Bingham expected = Bingham::about(pair.scene.orientation, {c.lambda3, c.kappa, c.kappa})
                               .rotated_right(model.orientation.conjugate());
  const int count = 100000;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  Vector3d mean = Vector3d::Zero(), variance = Vector3d::Zero();
  int reversed = 0;
  for (int i = 0; i < count; ++i) {
    const Pose known = bpa_sample_one(pair, random, true);
    const Eigen::Vector4d q = to_wxyz(known.rotation);
    scatter += q * q.transpose() / count;
    const Vector3d error = (known * model.point - pair.scene.point) / pair.sigma;
    mean += error / count;
    variance += error.cwiseAbs2() / count;
    const Pose unknown = bpa_sample_one(pair, random);
    const Quaterniond e = pair.scene.orientation.conjugate() * unknown.rotation * model.orientation;
    if (std::abs(e.x()) > std::abs(e.w())) ++reversed;
  }
  EXPECT_LT((scatter - expected.scatter()).cwiseAbs().maxCoeff(), 0.003);
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.015);
  EXPECT_LT((variance - Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.025);
  EXPECT_NEAR(reversed, 0.5 * count, 3 * 0.5 * std::sqrt(count));
}

}  // namespace
}  // namespace bpa::align
