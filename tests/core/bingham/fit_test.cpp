// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/bingham/fit.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector4d;

const Vector4d kConcentrations[] = {
    {0, 0, 0, 0},          {0, -1e-3, -0.5, -0.5}, {0, 0, -100, -100},    {0, -3, -50, -900},
    {0, -1e6, -1e6, -1e6}, {0, 0, 0, -1e5},        {0, -0.1, -1e4, -1e6}, {0, -2, -2, -2}};

TEST(FitBingham, RecoversTheBinghamOfAScatter) {
  RandomStream random(1);
  for (const Vector4d& lambda : kConcentrations) {
    const Bingham truth =
        Bingham::about(Bingham().sample(random), Eigen::Vector3d(lambda.tail<3>()));
    const Bingham fitted = fit_bingham(truth.scatter());
    for (int i = 1; i < 4; ++i) {
      EXPECT_NEAR(fitted.concentrations()[i], lambda[i], 1e-7 * (1 + std::abs(lambda[i])));
    }
    EXPECT_LT((fitted.scatter() - truth.scatter()).norm(), 1e-10);
    EXPECT_NEAR(kl_divergence(truth, fitted), 0, 1e-9);
  }
}

TEST(FitBingham, IsTheMostLikelyForItsSamples) {
  RandomStream random(2);
  for (const Vector4d& lambda : kConcentrations) {
    const Bingham truth =
        Bingham::about(Bingham().sample(random), Eigen::Vector3d(lambda.tail<3>()));
    std::vector<Quaterniond> samples;
    for (int i = 0; i < 2000; ++i) {
      const Quaterniond q = truth.sample(random);
      samples.push_back(i % 2 == 0 ? q : Quaterniond(-q.coeffs()));
    }
    const auto log_likelihood = [&](const Bingham& b) {
      double sum = 0;
      for (const Quaterniond& q : samples) sum += b.log_density(q);
      return sum;
    };
    const Bingham fitted = fit_bingham(samples);
    const double best = log_likelihood(fitted);
    // Twice the gain over the truth is chi-square of up to nine degrees of freedom.
    EXPECT_GE(best, log_likelihood(truth) - 1e-6);
    EXPECT_LT(2 * (best - log_likelihood(truth)), 33.7);
    for (int i = 0; i < 10; ++i) {
      Matrix4d change;
      for (int k = 0; k < 16; ++k) change.data()[k] = random.normal();
      const double size = 0.05 * (1 - fitted.concentrations()[1]);
      EXPECT_LE(log_likelihood(Bingham::from_exponent(fitted.exponent() +
                                                      size * (change + change.transpose()))),
                best);
    }
  }
}

TEST(FitBingham, WeightsCountLikeRepetitions) {
  RandomStream random(3);
  std::vector<Quaterniond> samples, repeated;
  std::vector<double> weights;
  for (int i = 0; i < 50; ++i) {
    samples.push_back(Bingham::about(Quaterniond::Identity(), {-9, -9, -2}).sample(random));
    weights.push_back(1 + i % 3);
    for (int k = 0; k < 1 + i % 3; ++k) repeated.push_back(samples.back());
  }
  const Bingham a = fit_bingham(samples, weights), b = fit_bingham(repeated);
  EXPECT_LT((a.exponent() - b.exponent()).norm(), 1e-8);
}

TEST(FitBingham, FewOrEqualSamplesStayFinite) {
  const std::vector<Quaterniond> same(10, Quaterniond(0.5, 0.5, 0.5, 0.5));
  const Bingham fitted = fit_bingham(same);
  EXPECT_TRUE(fitted.concentrations().allFinite());
  EXPECT_NEAR(std::abs(fitted.mode().dot(same[0])), 1, 1e-9);
  EXPECT_LT(fitted.concentrations()[1], -1e9);
  EXPECT_EQ(fit_bingham(std::vector<Quaterniond>{}).concentrations(), Vector4d::Zero());
}

}  // namespace
}  // namespace bpa
