// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/assignment.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/eval/pose_errors.hpp"

namespace bpa::eval {
namespace {

using CostMatrix = std::vector<std::vector<double>>;

// How many rows are paired, and what they cost in all.
struct Worth {
  int pairs = 0;
  double cost = 0;

  bool better_than(const Worth& other) const {
    return pairs != other.pairs ? pairs > other.pairs : cost < other.cost;
  }
};

Worth worth(const CostMatrix& costs, const std::vector<int>& column_of) {
  Worth sum;
  for (std::size_t row = 0; row < costs.size(); ++row) {
    if (column_of[row] < 0 || costs[row][column_of[row]] == kNoMatch) continue;
    ++sum.pairs;
    sum.cost += costs[row][column_of[row]];
  }
  return sum;
}

// The best of all permutations of max(rows, columns) columns; those beyond the last are none.
Worth best_of_all(const CostMatrix& costs, int columns) {
  const int size = std::max(static_cast<int>(costs.size()), columns);
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  Worth best{-1, 0};
  do {
    std::vector<int> column_of;
    for (std::size_t row = 0; row < costs.size(); ++row) {
      column_of.push_back(order[row] < columns ? order[row] : -1);
    }
    const Worth one = worth(costs, column_of);
    if (one.better_than(best)) best = one;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Assignment, IsTheBestOfAllOfSmallRandomMatrices) {
  RandomStream random(1);
  for (int i = 0; i < 400; ++i) {
    const int rows = 1 + random.index(6), columns = 1 + random.index(6);
    const double forbidden = random.index(3) * 0.3;
    CostMatrix costs(rows, std::vector<double>(columns));
    for (auto& row : costs) {
      for (double& cost : row) {
        cost = random.uniform() < forbidden ? kNoMatch : random.uniform(-3, 3);
      }
    }
    const std::vector<int> found = assigned(costs);
    ASSERT_EQ(found.size(), costs.size());
    std::vector<int> taken(columns, 0);
    for (int row = 0; row < rows; ++row) {
      if (found[row] < 0) continue;
      ASSERT_LT(found[row], columns);
      EXPECT_EQ(++taken[found[row]], 1);
      EXPECT_NE(costs[row][found[row]], kNoMatch);
    }
    const Worth mine = worth(costs, found), best = best_of_all(costs, columns);
    EXPECT_EQ(mine.pairs, best.pairs);
    EXPECT_NEAR(mine.cost, best.cost, 1e-9);
  }
}

TEST(Assignment, OfNothingIsNothing) {
  EXPECT_TRUE(assigned({}).empty());
  EXPECT_EQ(assigned({{}, {}}), (std::vector<int>{-1, -1}));
  EXPECT_EQ(assigned({{kNoMatch}}), std::vector<int>{-1});
}

}  // namespace
}  // namespace bpa::eval
