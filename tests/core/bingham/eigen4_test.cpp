// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/bingham/eigen4.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa {
namespace {

Eigen::Matrix4d random_orthogonal(RandomStream& random) {
  Eigen::Matrix4d m;
  for (int i = 0; i < 16; ++i) m.data()[i] = random.normal();
  return Eigen::HouseholderQR<Eigen::Matrix4d>(m).householderQ();
}

// Spectra from well separated to degenerate, at very different scales.
const Eigen::Vector4d kSpectra[] = {
    {0, 0, 0, 0},        {1, 0, 0, 0},          {0, 0, 0, -1},           {3, 3, -1, -5},
    {0, -1, -2, -3},     {0, -1e-9, -1, -2},    {1e9, 1e9 - 1, 0, -1e9}, {1e-200, 0, 0, -1e-200},
    {0, -1, -1e6, -1e6}, {0, -1e6, -1e6, -1e6}, {1e140, 0, -1, -2},      {5, 5, 5, -15}};

TEST(Eigen4, SpectrumDiagonalises) {
  RandomStream random(1);
  for (const Eigen::Vector4d& spectrum : kSpectra) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Matrix4d v = random_orthogonal(random);
      const Eigen::Matrix4d matrix = v * spectrum.asDiagonal() * v.transpose();
      const SymmetricEigen4 result = symmetric_eigen(matrix);
      const double scale = spectrum.cwiseAbs().maxCoeff();
      EXPECT_LE((result.values - spectrum).cwiseAbs().maxCoeff(), 4e-15 * scale);
      EXPECT_LT((result.vectors.transpose() * result.vectors - Eigen::Matrix4d::Identity()).norm(),
                1e-14);
      EXPECT_LE((matrix * result.vectors - result.vectors * result.values.asDiagonal()).norm(),
                2e-14 * scale);
    }
  }
}

TEST(Eigen4, DominantVectorAgreesWithEigensSolver) {
  RandomStream random(2);
  for (const Eigen::Vector4d& spectrum : kSpectra) {
    const double scale = spectrum.cwiseAbs().maxCoeff();
    for (int i = 0; i < 500; ++i) {
      const Eigen::Matrix4d v = random_orthogonal(random);
      const Eigen::Matrix4d matrix = v * spectrum.asDiagonal() * v.transpose();
      const Eigen::Vector4d dominant = dominant_eigenvector(matrix);
      EXPECT_NEAR(dominant.norm(), 1, 1e-14);
      // Rayleigh's quotient is the eigenvalue, also where the vector is not unique.
      EXPECT_LE((matrix * dominant - spectrum[0] * dominant).norm(), 2e-14 * scale);
      const double gap = (spectrum[0] - spectrum[1]) / (scale > 0 ? scale : 1);
      if (gap < 1e-3) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(matrix);
      EXPECT_LT(1 - std::abs(dominant.dot(v.col(0))), 1e-14);
      EXPECT_LT((dominant * dominant.dot(v.col(0)) - v.col(0)).norm(), 1e-14 / gap);
      EXPECT_LT(1 - std::abs(dominant.dot(solver.eigenvectors().col(3))), 1e-14);
    }
  }
}

}  // namespace
}  // namespace bpa
