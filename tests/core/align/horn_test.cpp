// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <vector>

#include <gtest/gtest.h>

#include "core/align/align.hpp"
#include "tests/core/align/align_problems.hpp"

// With positions only, the mode is the rotation of Horn (1987), here by the independent route of
// Kabsch and Umeyama: a singular value decomposition of the 3x3 cross-covariance.

namespace bpa::align {
namespace {

struct SvdAnswer {
  Pose pose;
  double gap = 0;  ///< How well the rotation is defined, relative to the largest singular value.
};

SvdAnswer solve_by_svd(const std::vector<PositionPair>& pairs) {
  double weight = 0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero(), y = Eigen::Vector3d::Zero();
  for (const PositionPair& p : pairs) {
    const double w = 1 / (p.sigma * p.sigma);
    weight += w, x += w * p.model, y += w * p.scene;
  }
  x /= weight, y /= weight;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PositionPair& p : pairs) {
    covariance += (p.scene - y) * (p.model - x).transpose() / (p.sigma * p.sigma);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d rotation =
      svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  const Eigen::Vector3d s = svd.singularValues();
  return {{Eigen::Quaterniond(rotation), y - rotation * x}, (s[1] + sign * s[2]) / s[0]};
}

double rotation_difference(const Pose& a, const Pose& b) {
  return (a.rotation.toRotationMatrix() - b.rotation.toRotationMatrix()).cwiseAbs().maxCoeff();
}

enum class Shape { random, planar, nearly_collinear, mirrored, few_pixels };

std::vector<PositionPair> make_problem(Shape shape, RandomStream& random) {
  const Pose truth = random_pose(random);
  const int count = 3 + random.index(20);
  std::vector<PositionPair> pairs(static_cast<std::size_t>(count));
  for (PositionPair& pair : pairs) {
    pair.model = random_vector(random, 0.05);
    if (shape == Shape::planar) pair.model.z() = 0;
    if (shape == Shape::nearly_collinear) pair.model.bottomRows<2>() *= 0.02;
    Eigen::Vector3d seen = pair.model;
    if (shape == Shape::mirrored) seen.x() *= -1;
    const double noise = shape == Shape::few_pixels ? 0.05 : 0.003;
    pair.scene = truth * seen + random_vector(random, noise);
    pair.sigma = random.uniform(0.001, 0.01);
  }
  return pairs;
}

class HornTest : public testing::TestWithParam<Shape> {};

TEST_P(HornTest, ModeIsHornsRotation) {
  RandomStream random(3);
  int defined = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<PositionPair> pairs = make_problem(GetParam(), random);
    const SvdAnswer svd = solve_by_svd(pairs);
    if (svd.gap < 1e-3) continue;
    ++defined;
    const Pose mode = bpa_mode({.positions = pairs}).camera_from_object;
    EXPECT_LT(rotation_difference(mode, svd.pose), 1e-12) << "gap " << svd.gap;
    EXPECT_LT((mode.translation - svd.pose.translation).norm(), 1e-12);
    const Pose icp = icp_mode({.positions = pairs}).camera_from_object;
    EXPECT_LT(rotation_difference(icp, svd.pose), 1e-12);
  }
  EXPECT_GT(defined, GetParam() == Shape::nearly_collinear ? 100 : 1800);
}

INSTANTIATE_TEST_SUITE_P(Shapes, HornTest,
                         testing::Values(Shape::random, Shape::planar, Shape::nearly_collinear,
                                         Shape::mirrored, Shape::few_pixels));

TEST(Horn, CollinearPointsLeaveOneAngleOpen) {
  RandomStream random(4);
  for (int i = 0; i < 100; ++i) {
    const Pose truth = random_pose(random);
    std::vector<PositionPair> pairs(5);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      pairs[k].model = Eigen::Vector3d(0.03 * static_cast<double>(k), 0, 0);
      pairs[k].scene = truth * pairs[k].model;
    }
    const PoseEstimate mode = bpa_mode({.positions = pairs});
    const Bingham posterior = Bingham::from_exponent(mode.exponent);
    EXPECT_NEAR(posterior.concentrations()[1], 0, 1e-9);
    EXPECT_LT(posterior.concentrations()[2], -100);
    const Eigen::Vector3d axis = mode.camera_from_object.rotation * Eigen::Vector3d::UnitX();
    EXPECT_LT((axis - truth.rotation * Eigen::Vector3d::UnitX()).norm(), 1e-9);
    EXPECT_NEAR(mode.log_score, 0, 1e-6);
  }
}

TEST(Horn, OnePointLeavesTheOrientationUniform) {
  const std::vector<PositionPair> pairs = {{{0.1, 0.2, 0.3}, {0, 0, 1}, 0.004}};
  const PoseEstimate mode = bpa_mode({.positions = pairs});
  EXPECT_NEAR(Bingham::from_exponent(mode.exponent).concentrations()[3], 0, 1e-12);
  EXPECT_TRUE(is_valid(mode.camera_from_object));
  EXPECT_LT((mode.camera_from_object * pairs[0].model - pairs[0].scene).norm(), 1e-12);
}

TEST(Horn, NoCorrespondencesAreNoInformation) {
  const PoseEstimate mode = bpa_mode({});
  EXPECT_TRUE(is_valid(mode.camera_from_object));
  EXPECT_EQ(mode.exponent.norm(), 0);
}

}  // namespace
}  // namespace bpa::align
