// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/random.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(RandomStream, SameNameSameNumbers) {
  RandomStream a(7, 3);
  RandomStream b(7, 3);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a(), b());
}

TEST(RandomStream, StreamsDiffer) {
  RandomStream a(7, 3);
  RandomStream b(7, 4);
  RandomStream c(8, 3);
  const auto first = a();
  EXPECT_NE(first, b());
  EXPECT_NE(first, c());
}

TEST(RandomStream, IndexIsUniform) {
  RandomStream random(1);
  std::vector<int> counts(7, 0);
  const int draws = 70000;
  for (int i = 0; i < draws; ++i) ++counts[static_cast<std::size_t>(random.index(7))];
  double chi_squared = 0;
  for (int count : counts) chi_squared += (count - 10000.0) * (count - 10000.0) / 10000.0;
  EXPECT_LT(chi_squared, 22.46);  // 6 degrees of freedom, 99.9 %
}

TEST(RandomStream, NormalHasUnitMoments) {
  RandomStream random(2);
  const int draws = 200000;
  double mean = 0, square = 0, fourth = 0;
  for (int i = 0; i < draws; ++i) {
    const double x = random.normal();
    mean += x / draws;
    square += x * x / draws;
    fourth += x * x * x * x / draws;
  }
  EXPECT_NEAR(mean, 0, 4 / std::sqrt(draws));
  EXPECT_NEAR(square, 1, 4 * std::sqrt(2.0 / draws));
  EXPECT_NEAR(fourth, 3, 4 * std::sqrt(96.0 / draws));
}

}  // namespace
}  // namespace bpa
