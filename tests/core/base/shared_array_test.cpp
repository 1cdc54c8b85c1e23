// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/shared_array.hpp"

#include <numeric>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(SharedArray, OwnsWhatWasBuilt) {
  SharedArray<int> copy;
  EXPECT_TRUE(copy.empty());
  {
    std::vector<int> built{3, 1, 2};
    const SharedArray<int> array = std::move(built);
    copy = array;
    EXPECT_EQ(copy.data(), array.data()) << "copies share";
  }
  EXPECT_EQ(copy.size(), 3u);
  EXPECT_EQ(copy[0], 3);
  EXPECT_EQ(copy.back(), 2);
  EXPECT_EQ(std::accumulate(copy.begin(), copy.end(), 0), 6);
}

TEST(SharedArray, KeepsTheOwnerOfItsElements) {
  auto memory = std::make_shared<std::vector<int>>(std::vector<int>{7, 8, 9});
  const std::weak_ptr<std::vector<int>> alive = memory;
  {
    const SharedArray<int> part(std::span<const int>(*memory).subspan(1), memory);
    memory.reset();
    ASSERT_FALSE(alive.expired());
    EXPECT_EQ(part, SharedArray<int>(std::vector<int>{8, 9}));
    EXPECT_FALSE(part == SharedArray<int>(std::vector<int>{8}));
  }
  EXPECT_TRUE(alive.expired());
}

}  // namespace
}  // namespace bpa
