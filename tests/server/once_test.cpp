// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/once.hpp"

#include <string>

#include <gtest/gtest.h>

namespace bpa::server {
namespace {

using Work = Once<std::string>;

static_assert(!std::is_copy_constructible_v<Work>, "two copies could both consume");
static_assert(!std::is_invocable_v<Work&>, "a call must be seen to consume: std::move(work)()");
static_assert(std::is_invocable_r_v<std::string, Work>);

TEST(Once, GivesAwayWhatItHoldsAndIsEmptyThen) {
  auto text = std::make_unique<std::string>("a message");
  Work work = [text = std::move(text)] { return std::move(*text); };
  Work moved = std::move(work);
  EXPECT_FALSE(work);
  ASSERT_TRUE(moved);
  EXPECT_EQ(std::move(moved)(), "a message");
  EXPECT_FALSE(moved);
}

}  // namespace
}  // namespace bpa::server
