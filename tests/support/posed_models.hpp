// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/model/object_model.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/solid_scene.hpp"

// The same objects as models (from meshes) and as solids to render.

namespace bpa::test {

inline std::shared_ptr<const ObjectModel> model_of(const TriangleMesh& mesh,
                                                   const std::string& name, int number,
                                                   const SymmetryGroup& symmetry = {}) {
  auto source = modeling::model_source_from_mesh(mesh, name, number);
  EXPECT_TRUE(source.ok()) << source.status().message;
  source->symmetry = symmetry;
  auto model = make_object_model(std::move(source).value());
  EXPECT_TRUE(model.ok()) << model.status().message;
  return std::move(model).value();
}

inline std::shared_ptr<const ObjectModel> l_model(int number = 1) {
  return model_of(l_mesh(), "l", number);
}
inline std::vector<Solid> l_solids(const Pose& camera_from_object) {
  const LShape l;
  const auto part = [&](const Eigen::Vector3f& half, const Eigen::Vector3f& centre) {
    const Pose object_from_part{Eigen::Quaterniond::Identity(), centre.cast<double>()};
    return Solid{Solid::Kind::box, half.cast<double>(), camera_from_object * object_from_part};
  };
  return {part(l.foot_half, l.foot_centre), part(l.tower_half, l.tower_centre)};
}

/// A brick of three different edges; half turns about its axes map it onto itself.
inline const Eigen::Vector3f kBrickHalf(0.060f, 0.040f, 0.025f);

inline SymmetryGroup brick_symmetry() {
  SymmetryGroup half_turns;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Quaterniond turn(0, 0, 0, 0);
    turn.vec()[axis] = 1;
    half_turns.discrete.push_back({turn, Eigen::Vector3d::Zero()});
  }
  return half_turns;
}
inline std::shared_ptr<const ObjectModel> brick_model(int number = 2) {
  return model_of(box_mesh(kBrickHalf), "brick", number, brick_symmetry());
}
inline Solid brick_solid(const Pose& camera_from_object) {
  return {Solid::Kind::box, kBrickHalf.cast<double>(), camera_from_object};
}

inline std::vector<Solid> together(std::vector<Solid> all, const std::vector<Solid>& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// `pose` moved by `distance` in some direction and turned by `angle` about some axis.
inline Pose disturbed(const Pose& pose, double distance, double angle, std::uint64_t seed) {
  RandomStream random(seed, 5);
  const auto direction = [&] {
    return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  };
  const Eigen::Vector3d shift = distance * direction();
  return {rotation_from_vector(angle * direction()) * pose.rotation, pose.translation + shift};
}

}  // namespace bpa::test
