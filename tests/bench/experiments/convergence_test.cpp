// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

#include "tests/bench/experiments/convergence.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/align/align_problems.hpp"

namespace bpa::cli {
namespace {

using align::random_pose;
using align::random_vector;

// A box of 12 x 8 x 5 cm with normals, a point every 5 mm.
PointCloud box() {
  PointCloud cloud;
  const Eigen::Vector3f half(0.06f, 0.04f, 0.025f);
  const float step = 0.005f;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const float side : {-1.0f, 1.0f}) {
      for (float a = -half[u]; a <= half[u]; a += step) {
        for (float b = -half[v]; b <= half[v]; b += step) {
          Eigen::Vector3f p, n = Eigen::Vector3f::Zero();
          p[axis] = side * half[axis];
          p[u] = a;
          p[v] = b;
          n[axis] = side;
          cloud.points.push_back(p);
          cloud.normals.push_back(n);
        }
      }
    }
  }
  return cloud;
}

// What a camera at the origin sees of it, with 1 mm of noise.
PointCloud seen(const PointCloud& model, const Pose& pose, RandomStream& random) {
  PointCloud scene;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const Eigen::Vector3d p = pose * model.points[i].cast<double>();
    const Eigen::Vector3d n = pose.rotation * model.normals[i].cast<double>();
    if (n.dot(p.normalized()) > -0.2) continue;
    scene.points.push_back((p + random_vector(random, 0.001)).cast<float>());
    scene.normals.push_back((n + random_vector(random, 0.05)).normalized().cast<float>());
  }
  return scene;
}

TEST(Convergence, OrientationTurnsInFasterOnABox) {
  RandomStream random(2);
  const PointCloud model = box();
  std::vector<PointCloud> scenes;
  std::vector<TruePlacement> placements;
  for (int i = 0; i < 4; ++i) {
    TruePlacement p;
    p.model = &model;
    p.camera_from_object = random_pose(random);
    scenes.push_back(seen(model, p.camera_from_object, random));
    placements.push_back(p);
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) placements[i].scene = &scenes[i];
  ConvergenceOptions options;
  options.starts = 12;
  const ConvergenceResult one = run_convergence(placements, options);
  EXPECT_EQ(one.trials, 48);
  ASSERT_EQ(one.bpa.position_m.size(), 21U);
  EXPECT_EQ(one.bpa.angle_rad[0], one.icp.angle_rad[0]);
  EXPECT_NEAR(one.bpa.angle_rad[0], 8 * M_PI / 180 * 1.6, 0.03);
  for (std::size_t k = 1; k < 21; ++k) {
    EXPECT_LE(one.bpa.position_m[k], one.bpa.position_m[k - 1]);
    EXPECT_LE(one.icp.angle_rad[k], one.icp.angle_rad[k - 1]);
  }
  for (std::size_t k : {0U, 1U, 2U, 3U, 5U, 10U, 20U}) {
    std::printf("after %2zu steps: BPA %4.1f mm %5.2f deg, ICP %4.1f mm %5.2f deg\n", k,
                1e3 * one.bpa.position_m[k], 180 / M_PI * one.bpa.angle_rad[k],
                1e3 * one.icp.position_m[k], 180 / M_PI * one.icp.angle_rad[k]);
  }
  for (std::size_t k : {2U, 3U, 5U}) {
    EXPECT_LT(one.bpa.angle_rad[k], 0.65 * one.icp.angle_rad[k]);
    EXPECT_LT(one.bpa.position_m[k], 1.1 * one.icp.position_m[k]);
  }
  EXPECT_LT(one.bpa.angle_rad[20], one.icp.angle_rad[20]);
  // Any number of threads, the same answer.
  options.num_threads = 1;
  const ConvergenceResult two = run_convergence(placements, options);
  EXPECT_EQ(one.bpa.position_m, two.bpa.position_m);
  EXPECT_EQ(one.icp.angle_rad, two.icp.angle_rad);
}

}  // namespace
}  // namespace bpa::cli
