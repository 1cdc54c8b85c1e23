// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <mutex>
#include <vector>

#include <gtest/gtest.h>

namespace bpa {
namespace {

class ParallelFor : public testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEveryIndexOnce) {
  for (int count : {0, 1, 2, 17, 1000}) {
    std::vector<int> visits(static_cast<std::size_t>(count), 0);
    parallel_for(
        count, GetParam(), [&](int i) { ++visits[static_cast<std::size_t>(i)]; }, 3);
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

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 8));

}  // namespace
}  // namespace bpa
