// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace bpa {

int resolve_num_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

// Threads of a loop that have nothing left to do; loops within it may use them.
using Spare = std::atomic<int>;
thread_local Spare* spare_of_outer_loop = nullptr;

bool take_spare() {
  Spare* spare = spare_of_outer_loop;
  if (!spare) return false;
  int left = *spare;
  while (left > 0 && !spare->compare_exchange_weak(left, left - 1)) {
  }
  return left > 0;
}

// Items that several threads take in turn, and the first failure.
class Queue {
 public:
  explicit Queue(int count) : count_(count), failed_(count) {}

  bool any_left() const { return next_ < count_; }
  // Calls body(item) until none is left.
  void work(const auto& body) {
    for (int item = next_++; item < count_; item = next_++) {
      try {
        body(item);
      } catch (...) {
        next_ = count_;  // those before this one have begun, so that the first failure is found
        const std::lock_guard<std::mutex> lock(mutex_);
        if (item < failed_) failure_ = std::current_exception();
        failed_ = std::min(failed_, item);
      }
    }
  }
  // When all threads are done.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const int count_;
  std::atomic<int> next_{0};
  std::mutex mutex_;
  int failed_;
  std::exception_ptr failure_;
};

}  // namespace

void parallel_for_pieces(int count, int grain, int num_threads,
                         const std::function<void(int, int, int)>& body) {
  if (count <= 0) return;
  grain = std::max(1, grain);
  const int pieces = (count + grain - 1) / grain;
  const int all = resolve_num_threads(num_threads), threads = std::min(all, pieces);
  Queue queue(pieces);
  Spare spare{all - threads};
  const auto work = [&](int thread) {
    Spare* const outer = std::exchange(spare_of_outer_loop, &spare);
    queue.work(
        [&](int piece) { body(piece * grain, std::min(count, (piece + 1) * grain), thread); });
    spare_of_outer_loop = outer;
    ++spare;
  };
  {
    std::vector<std::jthread> helpers;
    helpers.reserve(static_cast<std::size_t>(threads - 1));
    for (int thread = 1; thread < threads; ++thread) helpers.emplace_back(work, thread);
    work(0);
  }
  queue.rethrow();
}

void parallel_for_spare(int count, const std::function<void(int)>& body) {
  Queue queue(count);
  Spare* const spare = spare_of_outer_loop;
  {
    std::vector<std::jthread> helpers;
    queue.work([&](int index) {
      while (std::ssize(helpers) + 1 < count && queue.any_left() && take_spare()) {
        helpers.emplace_back([&] {
          queue.work(body);
          ++*spare;
        });
      }
      body(index);
    });
  }
  queue.rethrow();
}

}  // namespace bpa
