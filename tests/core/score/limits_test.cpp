// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/limits.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::score {
namespace {

// Placements whose log odds at one limit are 3 less an exponential of that mean.
std::vector<RightPlacement> exponential(int count, double mean) {
  RandomStream random(4);
  std::vector<RightPlacement> out(static_cast<std::size_t>(count));
  for (RightPlacement& one : out) {
    one.lowest.note(Limit::ranked, 3 + mean * std::log(random.uniform()));
    one.components.fill(std::numeric_limits<float>::infinity());
  }
  return out;
}

TEST(MeasureLimits, AreTheQuantilesOfAnExponential) {
  const auto right = exponential(20000, 1.5);
  const LearnedLimits limits = measure_limits(right, {}, default_score_layers().limits);
  for (const double q : {0.9, 0.99, 0.999, 0.9999}) {
    EXPECT_NEAR((*limits.at(q, true))[Limit::ranked], 3 + 1.5 * std::log(1 - q), 0.3) << q;
  }
}

TEST(MeasureLimits, AThousandPlacementsSayWhatKeepsMore) {
  const LearnedLimits limits =
      measure_limits(exponential(1000, 1.5), {}, default_score_layers().limits);
  EXPECT_NEAR((*limits.at(0.9999, true))[Limit::ranked], 3 + 1.5 * std::log(1e-4), 2.5);
}

TEST(MeasureLimits, KeepThoseOfTheStartWherePlacementsAreFew) {
  const LearnedLimits& start = default_score_layers().limits;
  const LearnedLimits limits = measure_limits(exponential(49, 1.5), exponential(500, 1.5), start);
  const Limits before = *start.at(0.999, true), after = *limits.at(0.999, true);
  EXPECT_EQ(after.stages, before.stages);
  EXPECT_EQ(after.components, before.components);
  EXPECT_NE((*limits.at(0.999, false))[Limit::ranked], (*start.at(0.999, false))[Limit::ranked]);
}

TEST(LowestLogOdds, KeepsTheLeast) {
  LowestLogOdds lowest;
  EXPECT_TRUE(std::isinf(lowest.stages[0]));
  for (const double log_odds : {-1.0, -3.0, 2.0}) lowest.note(Limit::ranked, log_odds);
  EXPECT_EQ(lowest.stages[0], -3);
}

}  // namespace
}  // namespace bpa::score
