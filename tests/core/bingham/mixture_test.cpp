// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "core/bingham/bingham.hpp"

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
  Matrix4d expected = Matrix4d::Zero();
  for (const auto& c : mixture.components) expected += c.weight * c.bingham.scatter();
  EXPECT_LT((scatter - expected).cwiseAbs().maxCoeff(), 4.5 * 0.5 / std::sqrt(count));
}

}  // namespace
}  // namespace bpa
