// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/guarded.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(Guarded, GivesBackWhatTheCallGives) {
  EXPECT_EQ(guarded("x", [] { return Result<int>(7); }).value(), 7);
  EXPECT_EQ(guarded("x", [] { return invalid_argument("no"); }).message, "no");
  bool called = false;
  EXPECT_TRUE(guarded("x", [&] { called = true; }).ok());
  EXPECT_TRUE(called);
}

TEST(Guarded, ExceptionsAreFailures) {
  const Status bug = guarded("the search failed", [] { throw std::out_of_range("vector"); });
  EXPECT_EQ(bug.code, StatusCode::internal);
  EXPECT_EQ(bug.message, "the search failed: vector");
  const auto memory = guarded("the search failed", []() -> Result<int> { throw std::bad_alloc(); });
  EXPECT_EQ(memory.status().code, StatusCode::unavailable);
  EXPECT_EQ(memory.status().message, "the search failed: no memory is left");
  const Status failed = guarded("the front cannot start", [] {
    throw Failure({StatusCode::not_found, "x"});
  });
  EXPECT_EQ(failed.code, StatusCode::not_found);
  EXPECT_EQ(failed.message, "the front cannot start: x");
  EXPECT_EQ(guarded("x", [] { throw 1; }).message, "x: unknown exception");
}

}  // namespace
}  // namespace bpa
