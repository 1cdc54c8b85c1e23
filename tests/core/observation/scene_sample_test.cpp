// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
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
  SceneSample sample;
  for (int rounds = 0;; ++rounds) {
    ASSERT_LT(rounds, 1000);
    sample = next_sample(scene, sample, {}, few());
    if (sample.empty()) break;
    EXPECT_LE(sample.keypoints.size(), 50u);
    EXPECT_LE(sample.pairs.references.size(), 80u);
    EXPECT_EQ(sample.pairs.references, sample.rim_pairs.references);
    keypoints.insert(sample.keypoints.begin(), sample.keypoints.end());
    references.insert(sample.pairs.references.begin(), sample.pairs.references.end());
    taken_keypoints += sample.keypoints.size();
    taken_references += sample.pairs.references.size();
  }
  EXPECT_EQ(keypoints.size(), taken_keypoints);
  EXPECT_EQ(references.size(), taken_references);
  EXPECT_EQ(keypoints.size(), scene.keypoints.size()) << "all in the end";
  EXPECT_EQ(references.size(), scene.coarse.size());
}

TEST_F(SceneSamples, ExplainedSurfaceIsLeftOut) {
  const SceneFeatures scene = features_of(everything());
  const int middle = scene.image.width / 2;
  std::vector<std::uint8_t> left_half(scene.image.pixels.size(), 0);
  for (std::size_t i = 0; i < left_half.size(); ++i) {
    left_half[i] = static_cast<int>(i) % scene.image.width < middle;
  }
  const SceneSample sample = next_sample(scene, {}, left_half, few());
  ASSERT_FALSE(sample.keypoints.empty());
  ASSERT_FALSE(sample.pairs.references.empty());
  for (const int k : sample.keypoints) {
    const int pixel = scene.image.pixel_of(scene.surface.points[scene.keypoints[k]]);
    EXPECT_GE(pixel % scene.image.width, middle);
  }
  for (const int r : sample.pairs.references) {
    EXPECT_GE(scene.image.pixel_of(scene.coarse.points[r]) % scene.image.width, middle);
  }
}

}  // namespace
}  // namespace bpa
