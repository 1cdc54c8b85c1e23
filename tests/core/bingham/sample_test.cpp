// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/bingham/bingham.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector4d;

TEST(BinghamSample, MomentsMatchTheGradient) {
  const double levels[] = {0, -0.5, -10, -900, -1e6};
  RandomStream random(1);
  std::printf("%28s  acceptance\n", "concentrations");
  for (double l1 : levels) {
    for (double l2 : levels) {
      for (double l3 : levels) {
        if (!(l1 >= l2 && l2 >= l3)) continue;
        const Vector4d lambda(0, l1, l2, l3);
        const BinghamNormalizer normalizer = bingham_normalizer(lambda);
        const int count = 40000;
        int trials = 0;
        Matrix4d second = Matrix4d::Zero();
        for (int i = 0; i < count; ++i) {
          const Vector4d x = sample_diagonal_bingham(lambda, random, &trials);
          ASSERT_NEAR(x.squaredNorm(), 1, 1e-12);
          second += x * x.transpose() / count;
        }
        std::printf("%9g %9g %9g  %.2f\n", l1, l2, l3, static_cast<double>(count) / trials);
        EXPECT_GT(static_cast<double>(count) / trials, 0.4);
        for (int i = 0; i < 4; ++i) {
          for (int j = 0; j <= i; ++j) {
            // Var[xi xj] = E[xi² xj²] - E[xi xj]².
            const double mean = i == j ? normalizer.gradient[i] : 0;
            const double variance = std::max(0.0, normalizer.fourth(i, j) - mean * mean);
            EXPECT_NEAR(second(i, j), mean, 4.5 * std::sqrt(variance / count) + 1e-9)
                << lambda.transpose() << " (" << i << ", " << j << ")";
          }
        }
      }
    }
  }
}

TEST(BinghamSample, EnergiesFollowTheirExactDistribution) {
  // Two and two equal: with u = x2² + x3², the energy k u has density e^-ku, cut at u = 1.
  RandomStream random(2);
  for (double k : {0.0, 2.0, 30.0}) {
    const int count = 100000, bins = 10;
    std::vector<int> histogram(bins);
    for (int i = 0; i < count; ++i) {
      const Vector4d x = sample_diagonal_bingham({0, 0, -k, -k}, random);
      const double u = x[2] * x[2] + x[3] * x[3];
      const double cumulative = k > 0 ? std::expm1(-k * u) / std::expm1(-k) : u;
      ++histogram[static_cast<std::size_t>(std::min(bins - 1.0, bins * cumulative))];
    }
    for (int bin : histogram) {
      EXPECT_NEAR(bin, count / bins, 4.5 * std::sqrt(0.09 * count)) << k;
    }
  }
}

TEST(BinghamSample, FarBeyondAnyNoise) {
  RandomStream random(3);
  const Bingham b = Bingham::about(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {-1e14, -1e14, -1e14});
  for (int i = 0; i < 1000; ++i) {
    EXPECT_NEAR(std::abs(b.sample(random).dot(b.mode())), 1, 1e-12);
  }
}

TEST(BinghamSample, SameSeedSameSamples) {
  const Bingham b = Bingham::about(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {-1.0, -10.0, -50.0});
  RandomStream one(7, 3), two(7, 3);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(b.sample(one).coeffs(), b.sample(two).coeffs());
}

}  // namespace
}  // namespace bpa
