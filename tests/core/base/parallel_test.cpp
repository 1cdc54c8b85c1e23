// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace bpa {
namespace {

class ParallelFor : public testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEveryIndexOnce) {
  for (int count : {0, 1, 2, 17, 1000}) {
    std::vector<int> visits(static_cast<std::size_t>(count), 0);
    parallel_for(count, GetParam(), [&](int i) { ++visits[static_cast<std::size_t>(i)]; });
    for (int visit : visits) ASSERT_EQ(visit, 1);
  }
}

TEST_P(ParallelFor, PiecesCoverTheRangeAndNameTheirThread) {
  std::mutex mutex;
  int covered = 0;
  parallel_for_pieces(100, 7, GetParam(), [&](int first, int last, int thread) {
    const std::lock_guard<std::mutex> lock(mutex);
    EXPECT_EQ(first % 7, 0);
    EXPECT_LE(last - first, 7);
    EXPECT_GE(thread, 0);
    EXPECT_LT(thread, resolve_num_threads(GetParam()));
    covered += last - first;
  });
  EXPECT_EQ(covered, 100);
}

TEST_P(ParallelFor, TheExceptionOfTheLowestIndexReachesTheCaller) {
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::vector<char> visited(1000, 0);
    std::string caught;
    try {
      parallel_for(1000, GetParam(), [&](int i) {
        visited[static_cast<std::size_t>(i)] = 1;
        if (i == 700 || i == 300 || i == 303) throw std::runtime_error(std::to_string(i));
      });
    } catch (const std::runtime_error& error) {
      caught = error.what();
    }
    ASSERT_EQ(caught, "300");
    for (std::size_t i = 0; i <= 300; ++i) ASSERT_TRUE(visited[i]) << i;
  }
}

TEST_P(ParallelFor, CanBeUsedAgainAfterAnException) {
  EXPECT_THROW(parallel_for(10, GetParam(), [](int) { throw 1; }), int);
  int sum = 0;
  std::mutex mutex;
  parallel_for(10, GetParam(), [&](int i) {
    const std::lock_guard<std::mutex> lock(mutex);
    sum += i;
  });
  EXPECT_EQ(sum, 45);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 8));

}  // namespace
}  // namespace bpa
