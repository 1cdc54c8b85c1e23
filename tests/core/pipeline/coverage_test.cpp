// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/coverage.hpp"

#include <numeric>
#include <random>

#include "core/model/model_index.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

constexpr double kSpacing = 0.01;
constexpr score::SearchYield kYield{
    .shape = 1.5, .tries = 40, .visible = 0.3, .objects = 2, .scenes = 0.5};

class CoverageOf : public test::LScene {
 protected:
  static Coverage fresh(const SceneFeatures& scene) {
    return Coverage(scene, {l_, brick_}, kYield, kSpacing);
  }
  static double sum(const std::vector<double>& missed) {
    return std::accumulate(missed.begin(), missed.end(), 0.0);
  }
  // Tries on an object where all points are tried.
  static double most_tries(const ObjectModel& model) {
    return kYield.visible * surface_area(model) / (kSpacing * kSpacing);
  }
};

TEST_F(CoverageOf, ExpectsWhatScenesHoldBeforeAnyTry) {
  const std::vector<double> missed = fresh(features_of(everything())).missed(0);
  EXPECT_NEAR(sum(missed), kYield.objects / kYield.scenes, 1e-9);
  EXPECT_NEAR(missed[0], missed[1], 1e-9);
}

// Scenes are drawn: of those where so many were discovered, the mean of the others.
TEST_F(CoverageOf, ExpectsTheMeanOfDrawnScenes) {
  const SceneFeatures scene = features_of(everything());
  Coverage coverage = fresh(scene);
  coverage.add_tries(scene.references, std::vector<std::uint8_t>{0, 0});
  const double of_l = std::pow(1 + most_tries(*l_) / kYield.tries, -kYield.shape);
  const double of_brick = std::pow(1 + most_tries(*brick_) / kYield.tries, -kYield.shape);
  std::mt19937 random(7);
  std::gamma_distribution<> mean(kYield.objects, 1 / kYield.scenes);
  std::bernoulli_distribution is_l(0.5), misses_l(of_l), misses_brick(of_brick);
  double missed = 0;
  int scenes = 0;
  for (int i = 0; i < 300000; ++i) {
    const int objects = std::poisson_distribution<>(mean(random))(random);
    int left = 0;
    for (int k = 0; k < objects; ++k)
      left += is_l(random) ? misses_l(random) : misses_brick(random);
    if (objects - left != 3) continue;
    ++scenes;
    missed += left;
  }
  ASSERT_GT(scenes, 10000);
  EXPECT_NEAR(sum(coverage.missed(3)), missed / scenes, 0.03 * missed / scenes);
}

TEST_F(CoverageOf, LeavesOutWhatIsExplainedAndWhatWasNotTried) {
  const SceneFeatures scene = features_of(everything());
  Coverage coverage = fresh(scene);
  coverage.explain(std::vector<float>(scene.image.pixels.size(), 0.75f));
  EXPECT_NEAR(sum(coverage.missed(0)), 0.25 * kYield.objects / kYield.scenes, 1e-6);
  coverage.add_tries(scene.references, std::vector<std::uint8_t>{0, 1});
  const std::vector<double> missed = coverage.missed(0);
  EXPECT_LT(missed[0], 0.8 * missed[1]);
}

}  // namespace
}  // namespace bpa
