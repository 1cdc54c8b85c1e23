// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.hpp"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(Result, AnExpiringResultGivesItsValueAway) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(7));
  const int* const address = result->get();
  const std::unique_ptr<int> taken = *std::move(result);  // a copy does not compile
  EXPECT_EQ(taken.get(), address);
}

TEST(Result, ANamedResultKeepsItsValue) {
  const Result<std::shared_ptr<int>> result(std::make_shared<int>(7));
  const std::shared_ptr<int> copy = *result;
  EXPECT_EQ(copy, *result);
}

}  // namespace
}  // namespace bpa
