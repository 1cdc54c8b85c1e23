// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/match_names.hpp"

#include <gtest/gtest.h>

namespace bpa::eval {
namespace {

using Numbers = std::map<int, int>;

TEST(MatchNames, NamesCountBeforeNumbers) {
  const ModelNames library{{1, "banana"}, {2, "mug"}, {3, "my_cup"}};
  EXPECT_EQ(matched({{1, "mug"}, {2, "banana"}, {7, "my cup"}}, library),
            (Numbers{{1, 2}, {2, 1}, {7, 3}}));
  EXPECT_EQ(matched({{1, "mug"}, {2, "drill"}}, library), (Numbers{{1, 2}}));
}

TEST(MatchNames, NumbersCountWhereOneHasNoNames) {
  const ModelNames library{{1, "banana"}, {2, "mug"}};
  EXPECT_EQ(matched({{2, "obj_000002"}, {3, ""}}, library), (Numbers{{2, 2}}));
  EXPECT_EQ(matched({{2, "mug"}, {1, "cup"}}, {{1, "obj_000001"}, {2, ""}}),
            (Numbers{{1, 1}, {2, 2}}));
  EXPECT_EQ(matched({{1, "mug"}}, {}), Numbers());
}

}  // namespace
}  // namespace bpa::eval
