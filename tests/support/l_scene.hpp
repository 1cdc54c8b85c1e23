// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/observation/scene_features.hpp"
#include "tests/support/posed_models.hpp"

namespace bpa::test {

/// An L and a brick on a table: the models, where they truly are, and what detection reads.
class LScene : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    l_ = l_model();
    brick_ = brick_model();
  }
  static void TearDownTestSuite() {
    l_.reset();
    brick_.reset();
  }

  static std::vector<Solid> table_only() { return {table(camera_from_world_)}; }
  static std::vector<Solid> everything() {
    return together(together(table_only(), l_solids(l_truth_)), {brick_solid(brick_truth_)});
  }
  static SceneFeatures features_of(const std::vector<Solid>& solids, float noise = 0,
                                   int num_threads = 0) {
    SurfaceMap map = surface_map(render(solids, kinect_camera(), noise, 8).frame, {});
    auto planes = label_background_planes(map, {});
    SceneFeatureOptions options;
    options.max_keypoints = options.round_keypoints = 2000;
    options.num_threads = num_threads;
    return scene_features(std::move(map), std::move(planes), options);
  }

  static inline std::shared_ptr<const ObjectModel> l_, brick_;
  static inline const Pose camera_from_world_ = look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  static inline const Pose l_truth_ = camera_from_world_ * standing_at(-0.08, 0, 0.02, 0.7);
  static inline const Pose brick_truth_ =
      camera_from_world_ * standing_at(0.12, 0.02, static_cast<double>(kBrickHalf.z()), -0.4);
};

}  // namespace bpa::test
