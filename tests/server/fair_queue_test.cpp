// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fair_queue.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace bpa::server {
namespace {

TEST(FairQueue, ClientsTakeTurnsInTheOrderTheyCame) {
  FairQueue<char, int> queue;
  for (const int item : {1, 2, 3}) queue.push('a', item);
  queue.push('b', 10);
  queue.push('c', 20);
  queue.push('b', 11);
  EXPECT_EQ(queue.size(), 6U);
  std::vector<int> order;
  while (const auto item = queue.pop()) order.push_back(*item);
  EXPECT_EQ(order, (std::vector<int>{1, 10, 20, 2, 11, 3}));
  EXPECT_TRUE(queue.empty());
}

TEST(FairQueue, WhoHasMostMakesRoom) {
  FairQueue<char, int> queue;
  EXPECT_FALSE(queue.displace_for('a'));
  for (const int item : {1, 2, 3}) queue.push('a', item);
  queue.push('b', 10);
  EXPECT_FALSE(queue.displace_for('a'));
  EXPECT_EQ(queue.displace_for('b'), 3);
  EXPECT_FALSE(queue.displace_for('b'));  // they would only change places
  EXPECT_EQ(queue.displace_for('c'), 2);
  EXPECT_FALSE(queue.displace_for('c'));
  EXPECT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue.pop_last('b'), 10);
  EXPECT_FALSE(queue.pop_last('b'));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_TRUE(queue.empty());
}

/// Against the queue itself: emptied, the item comes out after just so many others.
TEST(FairQueue, AheadOfNextIsWhatComesOutFirst) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    FairQueue<int, int> queue;
    for (int step = 0; step < 12; ++step) {
      if (random() % 4 == 0) {
        queue.pop();
      } else {
        queue.push(static_cast<int>(random() % 3), 0);
      }
    }
    const int client = static_cast<int>(random() % 4);
    const std::size_t expected = queue.ahead_of_next(client);
    queue.push(client, 1);
    std::size_t ahead = 0;
    while (*queue.pop() != 1) ++ahead;
    EXPECT_EQ(ahead, expected) << round;
  }
}

}  // namespace
}  // namespace bpa::server
