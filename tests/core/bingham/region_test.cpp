// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/bingham/credible_regions.hpp"

namespace bpa {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

const Vector3d kTurnConcentrations[] = {
    {0, 0, 0},        {-0.3, -1, -2}, {0, -100, -100},    {-2, -2, -2},  {-1, -1.0001, -500},
    {-20, -50, -900}, {0, 0, -40},    {-1e5, -2e5, -1e6}, {0, -1, -1e6}, {-3, -3, -1e5}};

TEST(CredibleRegion, HoldsAsManySamplesAsItSays) {
  RandomStream random(1);
  for (const Vector3d& lambda : kTurnConcentrations) {
    if (lambda.isZero()) continue;  // Every energy is 0.
    const Bingham b = Bingham::about(Bingham().sample(random), lambda);
    const int count = 40000;
    const double probabilities[] = {0.1, 0.5, 0.9, 0.95, 0.99};
    int inside[5] = {}, near[5] = {};
    double energies[5], angles[5];
    for (int k = 0; k < 5; ++k) {
      energies[k] = credible_energy(b, probabilities[k]);
      angles[k] = angle_bound(b, probabilities[k]);
      EXPECT_NEAR(credible_mass(b, energies[k]), probabilities[k], 1e-9);
      EXPECT_NEAR(angle_mass(b, angles[k]), probabilities[k], 1e-9);
    }
    for (int i = 0; i < count; ++i) {
      const Quaterniond q = b.sample(random);
      const double energy = -b.log_ratio_to_mode(q);
      const double angle = 2 * std::acos(std::min(1.0, std::abs(q.dot(b.mode()))));
      for (int k = 0; k < 5; ++k) {
        if (energy <= energies[k]) ++inside[k];
        if (angle <= angles[k]) ++near[k];
      }
    }
    for (int k = 0; k < 5; ++k) {
      const double p = probabilities[k];
      const double tolerance = 4 * std::sqrt(p * (1 - p) / count);
      EXPECT_NEAR(static_cast<double>(inside[k]) / count, p, tolerance) << lambda.transpose();
      EXPECT_NEAR(static_cast<double>(near[k]) / count, p, tolerance) << lambda.transpose();
    }
  }
}

TEST(CredibleRegion, ClosedForms) {
  // Two and two equal: the energy k u has density e^-ku, cut at u = 1.
  const Bingham two = Bingham::about(Quaterniond::Identity(), {0, -7, -7});
  for (double energy : {0.1, 1.0, 5.0, 6.9}) {
    EXPECT_NEAR(credible_mass(two, energy), std::expm1(-energy) / std::expm1(-7), 1e-10);
  }
  EXPECT_EQ(credible_mass(two, 7), 1);
  EXPECT_EQ(credible_mass(two, 0), 0);
  // Concentrated: twice the energy is chi-square with three degrees of freedom.
  const Bingham sharp = Bingham::about(Quaterniond::Identity(), {-1e8, -2e8, -4e8});
  for (double energy : {0.2, 1.0, 4.0}) {
    const double expected =
        std::erf(std::sqrt(energy)) - 2 * std::sqrt(energy / M_PI) * std::exp(-energy);
    EXPECT_NEAR(credible_mass(sharp, energy), expected, 1e-7);
  }
  // Uniform over rotations: an angle up to θ has probability (θ - sin θ) / π.
  for (double angle : {0.1, 1.0, 3.0}) {
    EXPECT_NEAR(angle_mass(Bingham(), angle), (angle - std::sin(angle)) / M_PI, 1e-11);
  }
}

TEST(CredibleRegion, IncreasesWithEnergy) {
  RandomStream random(2);
  for (int i = 0; i < 200; ++i) {
    const auto concentration = [&] { return -std::exp(random.uniform(-3, 12)); };
    const double l1 = concentration(), l2 = concentration(), l3 = concentration();
    const Bingham b = Bingham::about(Quaterniond::Identity(), {l1, l2, l3});
    double previous = 0;
    for (double energy = 1e-3; energy < 40; energy *= 1.5) {
      const double mass = credible_mass(b, energy);
      EXPECT_GE(mass, previous - 1e-7) << b.concentrations().transpose() << " " << energy;
      EXPECT_LE(mass, 1);
      previous = mass;
    }
    EXPECT_GT(previous, 1 - 1e-6);
  }
}

TEST(RotationCovariance, AgreesWithSamples) {
  RandomStream random(3);
  for (const Vector3d& lambda : kTurnConcentrations) {
    const Bingham b = Bingham::about(Bingham().sample(random), lambda);
    const Matrix3d covariance = rotation_covariance(b);
    const int count = 40000;
    Matrix3d sum = Matrix3d::Zero();
    for (int i = 0; i < count; ++i) {
      Quaterniond d = b.sample(random) * b.mode().conjugate();
      if (d.w() < 0) d.coeffs() *= -1;
      const double sine = d.vec().norm();
      const Vector3d omega =
          (sine > 0 ? 2 * std::atan2(sine, d.w()) / sine : 2.0) * Vector3d(d.vec());
      sum += omega * omega.transpose() / count;
    }
    // Entries vary by about √2 of the variances.
    const Vector3d deviation = covariance.diagonal().cwiseSqrt();
    const Matrix3d scaled = deviation.cwiseInverse().asDiagonal() * (sum - covariance) *
                            deviation.cwiseInverse().asDiagonal();
    EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 4.5 * std::sqrt(2.0 / count)) << lambda.transpose();
  }
  // Concentrated: an angle is twice its quaternion component, of variance 1 / 2|λ|.
  const Matrix3d sharp =
      rotation_covariance(Bingham::about(Quaterniond::Identity(), {-1e5, -2e5, -1e6}));
  EXPECT_NEAR(sharp(0, 0), 2e-5, 1e-9);
  EXPECT_NEAR(sharp(1, 1), 1e-5, 1e-9);
  EXPECT_NEAR(sharp(2, 2), 2e-6, 1e-9);
}

}  // namespace
}  // namespace bpa
