// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/bingham.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/bingham/credible_regions.hpp"

namespace bpa {
namespace {

using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

Quaterniond random_quaternion(RandomStream& random) { return Bingham().sample(random); }

Bingham random_bingham(RandomStream& random) {
  return Bingham::about(random_quaternion(random),
                        {-std::exp(random.uniform(-2, 6)), -std::exp(random.uniform(-2, 6)),
                         -std::exp(random.uniform(-2, 6))});
}

TEST(Bingham, UniformByDefault) {
  const Bingham uniform;
  EXPECT_NEAR(std::exp(uniform.log_density(Quaterniond(0.5, 0.5, 0.5, -0.5))),
              1 / (2 * M_PI * M_PI), 1e-13);
  EXPECT_NEAR(entropy(uniform), std::log(2 * M_PI * M_PI), 1e-12);
  EXPECT_LT((uniform.scatter() - 0.25 * Matrix4d::Identity()).norm(), 1e-11);
}

TEST(Bingham, ConstructionsAgree) {
  RandomStream random(1);
  for (int i = 0; i < 100; ++i) {
    const Bingham about = random_bingham(random);
    const Eigen::Matrix<double, 4, 3> axes = about.axes().rightCols<3>();
    const Bingham from_axes = Bingham::from_axes(about.concentrations().tail<3>(), axes);
    const Bingham shifted = Bingham::from_exponent(about.exponent() + 17 * Matrix4d::Identity());
    const Quaterniond q = random_quaternion(random);
    EXPECT_NEAR(about.log_density(q), from_axes.log_density(q), 1e-9);
    EXPECT_NEAR(about.log_density(q), shifted.log_density(q), 1e-9);
    EXPECT_NEAR(about.log_density(q), about.log_density(Quaterniond(-q.coeffs())), 1e-12);
    EXPECT_NEAR(about.log_ratio_to_mode(about.mode()), 0, 1e-10);
    EXPECT_LE(about.log_density(q), about.log_density(about.mode()));
  }
}

TEST(Bingham, RotationsMoveTheDensity) {
  RandomStream random(2);
  for (int i = 0; i < 100; ++i) {
    const Bingham b = random_bingham(random);
    const Quaterniond r = random_quaternion(random), q = random_quaternion(random);
    EXPECT_NEAR(b.rotated_right(r).log_density(q * r), b.log_density(q), 1e-9);
  }
}

TEST(Bingham, ProductAddsExponents) {
  RandomStream random(3);
  for (int i = 0; i < 100; ++i) {
    const Bingham a = random_bingham(random), b = random_bingham(random);
    const Bingham c = random_bingham(random);
    const Bingham factors[] = {a, b, c};
    const Bingham all = product(factors);
    const Quaterniond p = random_quaternion(random), q = random_quaternion(random);
    const auto sum = [&](const Quaterniond& x) {
      return a.log_density(x) + b.log_density(x) + c.log_density(x);
    };
    EXPECT_NEAR(all.log_density(p) - all.log_density(q), sum(p) - sum(q), 1e-8);
    EXPECT_NEAR(product(product(a, b), c).log_density(p), all.log_density(p), 1e-8);
    EXPECT_NEAR(product(a, Bingham()).log_density(p), a.log_density(p), 1e-9);
  }
}

TEST(Bingham, EntropyAndDivergenceAgreeWithAverages) {
  RandomStream random(4);
  for (int i = 0; i < 6; ++i) {
    const Bingham a = random_bingham(random);
    const Bingham b = product(a, random_bingham(random));
    EXPECT_NEAR(kl_divergence(a, a), 0, 1e-10);
    const int count = 100000;
    double mean = 0, divergence = 0, squares = 0;
    for (int k = 0; k < count; ++k) {
      const Quaterniond q = a.sample(random);
      mean -= a.log_density(q) / count;
      const double difference = a.log_density(q) - b.log_density(q);
      divergence += difference / count;
      squares += difference * difference / count;
    }
    // The log density of three dimensions varies by √1.5 or less.
    EXPECT_NEAR(entropy(a), mean, 4 * std::sqrt(1.5 / count));
    EXPECT_NEAR(kl_divergence(a, b), divergence,
                4 * std::sqrt((squares - divergence * divergence) / count) + 1e-9);
  }
}

TEST(Bingham, ProductMatricesMultiply) {
  RandomStream random(5);
  const Quaterniond r = random_quaternion(random), q = random_quaternion(random);
  const Quaterniond left = r * q, right = q * r;
  const Vector4d v(q.w(), q.x(), q.y(), q.z());
  EXPECT_LT((left_product(r) * v - Vector4d(left.w(), left.x(), left.y(), left.z())).norm(), 1e-14);
  EXPECT_LT((right_product(r) * v - Vector4d(right.w(), right.x(), right.y(), right.z())).norm(),
            1e-14);
}

}  // namespace
}  // namespace bpa
