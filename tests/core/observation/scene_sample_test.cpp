// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

class SceneSamples : public test::LScene {
 protected:
  static SceneFeatureOptions few() {
    SceneFeatureOptions options;
    options.round_keypoints = 50;
    options.max_references = 80;
    return options;
  }
};

TEST_F(SceneSamples, NoPointIsInTwo) {
  const SceneFeatures scene = features_of(everything());
  std::set<int> keypoints, references;
  std::size_t taken_keypoints = 0, taken_references = 0;
  SampledSoFar passed;
  for (int rounds = 0;; ++rounds) {
    ASSERT_LT(rounds, 1000);
    const SamplePoints points = next_points(scene, {}, few(), passed);
    if (points.empty()) break;
    EXPECT_LE(points.keypoints.size(), 50u);
    EXPECT_LE(points.references.size(), 80u);
    const SceneSample sample = scene_sample(scene, points, {}, few());
    EXPECT_EQ(sample.points, points);
    EXPECT_EQ(sample.pairs.references, points.references);
    EXPECT_EQ(sample.rim_pairs.references, points.references);
    keypoints.insert(points.keypoints.begin(), points.keypoints.end());
    references.insert(points.references.begin(), points.references.end());
    taken_keypoints += points.keypoints.size();
    taken_references += points.references.size();
  }
  EXPECT_EQ(keypoints.size(), taken_keypoints);
  EXPECT_EQ(references.size(), taken_references);
  EXPECT_EQ(keypoints.size(), scene.keypoints.size()) << "all in the end";
  EXPECT_EQ(references.size(), scene.coarse.size());
}

// A cube of 25 mm gives no second point before all have given one, no third before a second, ...
TEST_F(SceneSamples, ReferencesSpreadEvenly) {
  const SceneFeatures scene = features_of(everything());
  const auto cube = [&scene](int point) {
    const Eigen::Array3f scaled = scene.coarse.points[point].array() / 0.025f;
    return std::array{std::floor(scaled.x()), std::floor(scaled.y()), std::floor(scaled.z())};
  };
  std::map<std::array<float, 3>, std::size_t> points, given;
  for (std::size_t i = 0; i < scene.coarse.size(); ++i) ++points[cube(static_cast<int>(i))];
  ASSERT_LT(points.size(), scene.coarse.size() / 2);
  for (const int reference : scene.references) {
    const std::size_t now = ++given[cube(reference)];
    for (const auto& [other, count] : points) ASSERT_GE(given[other], std::min(count, now - 1));
  }
}

TEST_F(SceneSamples, ExplainedSurfaceIsLeftOut) {
  const SceneFeatures scene = features_of(everything());
  const int middle = scene.image.width / 2;
  std::vector<std::uint8_t> left_half(scene.image.pixels.size(), 0);
  for (std::size_t i = 0; i < left_half.size(); ++i) {
    left_half[i] = static_cast<int>(i) % scene.image.width < middle;
  }
  SampledSoFar passed;
  const SamplePoints points = next_points(scene, left_half, few(), passed);
  ASSERT_FALSE(points.keypoints.empty());
  ASSERT_FALSE(points.references.empty());
  for (const int k : points.keypoints) {
    const int pixel = scene.image.pixel_of(scene.surface.points[scene.keypoints[k]]);
    EXPECT_GE(pixel % scene.image.width, middle);
  }
  for (const int r : points.references) {
    EXPECT_GE(scene.image.pixel_of(scene.coarse.points[r]) % scene.image.width, middle);
  }
}

}  // namespace
}  // namespace bpa
