// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/search_yield.hpp"

#include <random>

#include <gtest/gtest.h>

namespace bpa::score {
namespace {

// Objects with a chance of their own at each try, as the standard library draws them: found in the
// first of the rounds that has them.
std::vector<Discovery> drawn(int count, double shape, double tries) {
  std::mt19937 random(3);
  std::gamma_distribution<> rate(shape, 1 / tries);
  std::vector<Discovery> out;
  while (std::ssize(out) < count) {
    const double at = std::exponential_distribution<>(rate(random))(random);
    for (double tried = 4; tried < 1e6; tried *= 2) {
      if (at >= tried) continue;
      out.push_back({tried == 4 ? 0 : tried / 2, tried, 0.3});
      break;
    }
  }
  return out;
}

TEST(MeasureYield, IsThatOfDrawnObjects) {
  for (const auto& [shape, tries] : {std::pair(1.0, 2.0), {1.6, 5.0}, {3.0, 20.0}}) {
    const SearchYield yield = measure_yield(drawn(20000, shape, tries), {1, 5, 9}, {});
    for (const double tried : {1, 4, 16, 64}) {
      const double expected = std::pow(tries / (tries + tried), shape);
      EXPECT_NEAR(yield.undiscovered(tried), expected, 0.02) << shape << " " << tried;
    }
    EXPECT_NEAR(yield.visible, 0.3, 1e-9);
  }
}

TEST(MeasureYield, CountsObjectsAsTheyVary) {
  std::mt19937 random(4);
  std::vector<int> objects;
  for (int frame = 0; frame < 20000; ++frame) {
    const double mean = std::gamma_distribution<>(2, 1 / 0.5)(random);
    objects.push_back(std::poisson_distribution<>(mean)(random));
  }
  const SearchYield yield = measure_yield(drawn(100, 1, 2), objects, {});
  EXPECT_NEAR(yield.objects, 2, 0.1);
  EXPECT_NEAR(yield.scenes, 0.5, 0.03);
  EXPECT_TRUE(measure_yield(drawn(100, 1, 2), {4, 4, 4}, {}).is_valid());
}

TEST(MeasureYield, IsThatOfTheStartWithFewDiscoveries) {
  const SearchYield start{.shape = 7};
  EXPECT_EQ(measure_yield(drawn(49, 1, 2), {1}, start).shape, 7);
}

}  // namespace
}  // namespace bpa::score
