// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <algorithm>
#include <chrono>
#include <latch>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
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

TEST_P(ParallelFor, SpareThreadsVisitEveryInnerIndexOnce) {
  constexpr int kOuter = 3, kInner = 200;
  std::vector<int> visits(kOuter * kInner, 0);
  parallel_for(kOuter, GetParam(), [&](int i) {
    parallel_for_spare(i == 0 ? kInner : 2, [&](int k) { ++visits[i * kInner + k]; });
  });
  int sum = 0;
  for (const int visit : visits) sum += visit;
  EXPECT_EQ(sum, kInner + 4);
  EXPECT_EQ(*std::ranges::max_element(visits), 1);
}

TEST_P(ParallelFor, AnInnerLoopRunsOnAllThreadsWhileTheOuterOneHasOneItem) {
  const int threads = resolve_num_threads(GetParam());
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallel_for(1, threads, [&](int) {
    std::latch all(threads);  // each waits for the others: fewer would wait for ever
    parallel_for_spare(threads, [&](int) {
      all.arrive_and_wait();
      const std::lock_guard<std::mutex> lock(mutex);
      ids.insert(std::this_thread::get_id());
    });
  });
  EXPECT_EQ(std::ssize(ids), threads);
}

TEST_P(ParallelFor, ThreadsThatAreDoneHelpTheInnerLoopsOfOthers) {
  const int threads = resolve_num_threads(GetParam());
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallel_for(threads, threads, [&](int i) {
    if (i > 0) return;
    // Ends when all threads have taken part.
    parallel_for_spare(1 << 20, [&](int) {
      std::unique_lock<std::mutex> lock(mutex);
      if (std::ssize(ids) == threads) return;
      ids.insert(std::this_thread::get_id());
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    });
  });
  EXPECT_EQ(std::ssize(ids), threads);
}

TEST_P(ParallelFor, TheExceptionOfTheLowestInnerIndexReachesTheCaller) {
  std::string caught;
  try {
    parallel_for(1, GetParam(), [](int) {
      parallel_for_spare(100, [](int k) {
        if (k == 70 || k == 30) throw std::runtime_error(std::to_string(k));
      });
    });
  } catch (const std::runtime_error& error) {
    caught = error.what();
  }
  EXPECT_EQ(caught, "30");
}

TEST(ParallelForSpare, RunsAloneWithoutALoopAroundIt) {
  const std::thread::id own = std::this_thread::get_id();
  int count = 0;
  parallel_for_spare(5, [&](int k) {
    EXPECT_EQ(k, count++);
    EXPECT_EQ(std::this_thread::get_id(), own);
  });
  EXPECT_EQ(count, 5);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 8));

}  // namespace
}  // namespace bpa
