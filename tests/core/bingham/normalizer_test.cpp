// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/normalizer.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/bingham/bingham_oracle.hpp"

namespace bpa {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

// Concentrations from 0 to 1e6, equal and unequal, in every combination.
std::vector<Vector4d> grid() {
  const double levels[] = {0, -1e-6, -0.01, -1, -7, -100, -900, -1e4, -123456, -1e6};
  std::vector<Vector4d> lambdas;
  for (double l1 : levels) {
    for (double l2 : levels) {
      for (double l3 : levels) {
        if (l1 >= l2 && l2 >= l3) lambdas.push_back({0, l1, l2, l3});
      }
    }
  }
  return lambdas;
}

TEST(BinghamNormalizer, AgreesWithTheCircleSplittingIntegral) {
  double worst_f = 0, worst_gradient = 0, worst_entropy = 0;
  for (const Vector4d& lambda : grid()) {
    const oracle::Normalizer truth = oracle::normalizer(lambda);
    const BinghamNormalizer ours = bingham_normalizer(lambda);
    EXPECT_EQ(ours.log_f, bingham_log_normalizer(lambda));
    worst_f = std::max(worst_f, std::abs(std::expm1(ours.log_f - truth.log_f)));
    worst_gradient = std::max(
        worst_gradient,
        ((ours.gradient - truth.gradient).array() / truth.gradient.array()).abs().maxCoeff());
    const double entropy = ours.log_f - lambda.dot(ours.gradient);
    const double true_entropy = truth.log_f - lambda.dot(truth.gradient);
    worst_entropy =
        std::max(worst_entropy, std::abs(entropy - true_entropy) / std::abs(true_entropy));
  }
  std::printf("%zu spectra: worst relative error of F %.1e, gradient %.1e, entropy %.1e\n",
              grid().size(), worst_f, worst_gradient, worst_entropy);
  EXPECT_LT(worst_f, 1e-12);
  EXPECT_LT(worst_gradient, 1e-11);
  EXPECT_LT(worst_entropy, 1e-11);
}

TEST(BinghamNormalizer, ClosedForms) {
  EXPECT_NEAR(bingham_log_normalizer(Vector4d::Zero()), std::log(2 * M_PI * M_PI), 1e-11);
  // Two and two equal: 2π² (1 - e^-k) / k.
  for (double k : {1e-3, 1.0, 50.0, 1e5}) {
    EXPECT_NEAR(bingham_log_normalizer({0, 0, -k, -k}),
                std::log(2 * M_PI * M_PI * -std::expm1(-k) / k), 1e-11);
  }
  // Concentrated: a Gaussian in the three tangent directions, at both q and -q.
  EXPECT_NEAR(bingham_log_normalizer({0, -1e9, -2e9, -5e9}),
              std::log(2 * std::pow(M_PI, 1.5) / std::sqrt(1e28)), 1e-8);
  // Adding a constant to the exponent multiplies F; order does not matter.
  EXPECT_NEAR(bingham_log_normalizer({7, 4, -3, 6.5}),
              7 + bingham_log_normalizer({0, -0.5, -3, -10}), 1e-12);
}

TEST(BinghamNormalizer, DerivativesAreThoseOfTheFunction) {
  for (const Vector4d& lambda :
       {Vector4d(0, 0, 0, 0), Vector4d(0, -1, -5, -30), Vector4d(0, 0, -100, -100)}) {
    const BinghamNormalizer n = bingham_normalizer(lambda);
    EXPECT_NEAR(n.gradient.sum(), 1, 1e-11);
    EXPECT_LT((n.fourth.rowwise().sum() - n.gradient).norm(), 1e-10);
    for (int i = 0; i < 4; ++i) {
      const double h = 1e-4;
      const Vector4d step = h * Vector4d::Unit(i);
      const double up = bingham_log_normalizer(lambda + step);
      const double down = bingham_log_normalizer(lambda - step);
      EXPECT_NEAR(n.gradient[i], (up - down) / (2 * h), 1e-7);
      const Vector4d column = (bingham_normalizer(lambda + step).gradient -
                               bingham_normalizer(lambda - step).gradient) /
                              (2 * h);
      const Vector4d covariance = n.fourth.col(i) - n.gradient * n.gradient[i];
      EXPECT_LT((covariance - column).norm(), 1e-7);
    }
  }
}

TEST(BinghamNormalizer, MonotoneAndFiniteFarBeyond) {
  for (const Vector3d& shape :
       {Vector3d(1, 1, 1), Vector3d(0, 0, 1), Vector3d(1e-9, 1e-3, 1), Vector3d(0, 1, 1)}) {
    double previous = bingham_log_normalizer(Vector4d::Zero()) + 1e-12;
    for (double size = 1e-3; size < 1e300; size *= 3) {
      const Vector4d lambda(0, -size * shape[0], -size * shape[1], -size * shape[2]);
      const BinghamNormalizer n = bingham_normalizer(lambda);
      EXPECT_TRUE(std::isfinite(n.log_f) && n.gradient.allFinite()) << lambda.transpose();
      EXPECT_LT(n.log_f, previous) << lambda.transpose();
      EXPECT_TRUE((n.gradient.array() >= 0).all()) << lambda.transpose();
      EXPECT_NEAR(n.gradient.sum(), 1, 1e-10) << lambda.transpose();
      previous = n.log_f;
    }
  }
}

TEST(BinghamNormalizer, OnTheTwoSphere) {
  EXPECT_NEAR(bingham_log_normalizer_s2(Vector3d::Zero()), std::log(4 * M_PI), 1e-11);
  for (double k : {0.1, 3.0, 200.0}) {
    // exp(-k (1 - z²)) by Simpson's rule in z.
    const int n = 200000;
    double sum = 0, second = 0;
    for (int i = 0; i <= n; ++i) {
      const double z = static_cast<double>(i) / n;
      const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * n);
      sum += weight * std::exp(-k * (1 - z * z));
      second += weight * std::exp(-k * (1 - z * z)) * z * z;
    }
    EXPECT_NEAR(bingham_log_normalizer_s2({-k, 0, -k}), std::log(4 * M_PI * sum), 1e-10);
    const Vector3d gradient = bingham_gradient_s2({-k, 0, -k});
    EXPECT_NEAR(gradient[1], second / sum, 1e-10);
    EXPECT_NEAR(gradient[0], gradient[2], 1e-12);
    EXPECT_NEAR(gradient.sum(), 1, 1e-11);
  }
}

}  // namespace
}  // namespace bpa
