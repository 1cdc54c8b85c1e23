// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/mixture.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector4d;

BinghamMixture random_mixture(int count, double concentration, RandomStream& random) {
  BinghamMixture mixture;
  double total = 0;
  for (int i = 0; i < count; ++i) {
    const double weight = random.uniform(0.1, 1);
    const Eigen::Vector3d lambda(-concentration * random.uniform(), -concentration,
                                 -concentration * random.uniform());
    mixture.components.push_back({weight, Bingham::about(Bingham().sample(random), lambda)});
    total += weight;
  }
  for (auto& c : mixture.components) c.weight /= total;
  return mixture;
}

TEST(BinghamMixture, DensityIntegratesToOne) {
  RandomStream random(1);
  const BinghamMixture mixture = random_mixture(4, 5, random);
  const int count = 200000;
  double mean = 0, squares = 0;
  for (int i = 0; i < count; ++i) {  // Over uniform orientations.
    const double value = 2 * M_PI * M_PI * std::exp(mixture.log_density(Bingham().sample(random)));
    mean += value / count;
    squares += value * value / count;
  }
  EXPECT_NEAR(mean, 1, 4 * std::sqrt((squares - 1) / count));
}

TEST(BinghamMixture, SamplesHaveItsScatter) {
  RandomStream random(2);
  const BinghamMixture mixture = random_mixture(3, 20, random);
  const int count = 100000;
  Matrix4d scatter = Matrix4d::Zero();
  for (int i = 0; i < count; ++i) {
    const Quaterniond q = mixture.sample(random);
    const Vector4d v(q.w(), q.x(), q.y(), q.z());
    scatter += v * v.transpose() / count;
  }
  EXPECT_LT((scatter - mixture.scatter()).cwiseAbs().maxCoeff(), 4.5 * 0.5 / std::sqrt(count));
}

TEST(BinghamMixture, ProductIsTheProductOfDensities) {
  RandomStream random(3);
  const BinghamMixture a = random_mixture(3, 10, random), b = random_mixture(2, 15, random);
  const BinghamMixture c = product(a, b);
  EXPECT_EQ(c.components.size(), 6U);
  const auto sum = [&](const Quaterniond& q) { return a.log_density(q) + b.log_density(q); };
  const Quaterniond reference = Bingham().sample(random);
  for (int i = 0; i < 100; ++i) {
    const Quaterniond q = Bingham().sample(random);
    EXPECT_NEAR(c.log_density(q) - c.log_density(reference), sum(q) - sum(reference), 1e-9);
  }
}

TEST(BinghamMixture, ModeIsTheHighestPointFound) {
  RandomStream random(4);
  for (int i = 0; i < 20; ++i) {
    const BinghamMixture mixture = random_mixture(4, 30, random);
    const double height = mixture.log_density(mixture.mode());
    for (int k = 0; k < 2000; ++k) {
      EXPECT_LE(mixture.log_density(mixture.sample(random)), height + 1e-9);
    }
  }
}

TEST(BinghamMixture, ReductionKeepsTheScatterAndMergesWhatIsAlike) {
  RandomStream random(5);
  // Two clusters, each of three nearly equal components.
  BinghamMixture mixture;
  const Quaterniond centres[] = {Quaterniond::Identity(), Quaterniond(0, 1, 0, 0)};
  for (const Quaterniond& centre : centres) {
    for (int i = 0; i < 3; ++i) {
      const Quaterniond q = Bingham::about(centre, {-2e4, -2e4, -2e4}).sample(random);
      mixture.components.push_back({1.0 / 6, Bingham::about(q, {-100, -100, -100})});
    }
  }
  const BinghamMixture two = reduce(mixture, 2);
  ASSERT_EQ(two.components.size(), 2U);
  EXPECT_NEAR(two.components[0].weight, 0.5, 1e-12);
  EXPECT_LT((two.scatter() - mixture.scatter()).norm(), 1e-9);
  EXPECT_NEAR(std::abs(two.components[0].bingham.mode().dot(centres[0])), 1, 1e-3);
  EXPECT_NEAR(std::abs(two.components[1].bingham.mode().dot(centres[1])), 1, 1e-3);
  const BinghamMixture one = reduce(mixture, 1);
  ASSERT_EQ(one.components.size(), 1U);
  EXPECT_LT((one.scatter() - mixture.scatter()).norm(), 1e-9);
  EXPECT_EQ(reduce(mixture, 10).components.size(), 6U);
}

}  // namespace
}  // namespace bpa
