// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/near_symmetry.hpp"

#include <gtest/gtest.h>

#include "core/model/model_index.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"

namespace bpa {
namespace {

std::shared_ptr<const ObjectModel> model_of(const TriangleMesh& mesh, SymmetryGroup exact = {}) {
  auto source = modeling::model_source_from_mesh(mesh, "thing", 1);
  EXPECT_TRUE(source.ok());
  source->symmetry = std::move(exact);
  return make_object_model(std::move(*source)).value();
}

// The share of the surface that lies on it after the motion, by looking at every pair of points.
double brute_force_share(const ObjectModel& model, const Pose& motion, float tolerance) {
  const PointCloud& surface = model.surface;
  const Eigen::Matrix3f r = motion.matrix().cast<float>();
  const Eigen::Vector3f t = motion.translation.cast<float>();
  int on = 0, all = 0;
  for (std::size_t i = 0; i < surface.size(); i += 7) {
    const Eigen::Vector3f p = r * surface.points[i] + t, n = r * surface.normals[i];
    bool met = false;
    for (std::size_t j = 0; j < surface.size() && !met; ++j) {
      const Eigen::Vector3f d = p - surface.points[j];
      met = surface.normals[j].dot(n) > 0.7f && d.norm() < 3 * tolerance &&
            std::abs(d.dot(surface.normals[j])) < tolerance;
    }
    on += met;
    ++all;
  }
  return static_cast<double>(on) / all;
}

bool contains(const std::vector<Pose>& motions, const Pose& wanted) {
  return std::any_of(motions.begin(), motions.end(), [&](const Pose& motion) {
    const PoseError error = pose_error(motion, wanted);
    return error.position < 0.002 && error.angle < 0.03;
  });
}

const Eigen::Vector3f kBox{0.05f, 0.04f, 0.025f};

SymmetryGroup half_turns() {
  SymmetryGroup group;
  for (int k = 0; k < 3; ++k) {
    group.discrete.push_back({rotation_from_vector(M_PI * Eigen::Vector3d::Unit(k)), {0, 0, 0}});
  }
  return group;
}

TEST(NearSymmetry, ABoxOfWhichNothingIsDeclaredHasItsHalfTurns) {
  const auto model = model_of(test::box_mesh(kBox));
  for (const Pose& turn : half_turns().discrete) {
    EXPECT_TRUE(contains(model->index->near_symmetries, turn));
  }
}

TEST(NearSymmetry, WhatIsExactIsNotNear) {
  const auto model = model_of(test::box_mesh(kBox), half_turns());
  for (const Pose& turn : half_turns().discrete) {
    EXPECT_FALSE(contains(model->index->near_symmetries, turn));
  }
}

// A beaker with a block for a handle.
TEST(NearSymmetry, AMugTurnsAboutItsAxis) {
  TriangleMesh mug = test::cup_mesh(0.04, 0.003, 0.09);
  test::add_box(mug, {0.012f, 0.005f, 0.025f}, {0.05f, 0, 0.045f});
  const auto model = model_of(mug);
  const Eigen::Vector3d on_axis(0, 0, 0.045);
  int upright = 0;
  for (const Pose& turn : model->index->near_symmetries) {
    EXPECT_GT(brute_force_share(*model, turn, 0.03f * static_cast<float>(model->diameter)), 0.55);
    const double up = (turn.rotation * Eigen::Vector3d::UnitZ()).z();
    if (up < 0) continue;  // standing on its rim, most of it looks the same
    ++upright;
    EXPECT_GT(up, std::cos(0.04));
    EXPECT_LT((turn.rotation * on_axis + turn.translation - on_axis).norm(), 0.003);
  }
  EXPECT_GE(upright, 20) << "one for each 15 degrees, but for none";
}

TEST(NearSymmetry, OfAnLMayBeHalfTurnsButNoQuarterTurns) {
  const auto model = model_of(test::l_mesh());
  for (const Pose& motion : model->index->near_symmetries) {
    EXPECT_GT(brute_force_share(*model, motion, 0.03f * static_cast<float>(model->diameter)), 0.55);
    const double angle = vector_from_rotation(motion.rotation).norm();
    EXPECT_TRUE(angle < 0.6 || angle > M_PI - 0.2) << angle;
  }
}

}  // namespace
}  // namespace bpa
