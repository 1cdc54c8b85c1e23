// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace bpa {

int resolve_num_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for_pieces(int count, int grain, int num_threads,
                         const std::function<void(int, int, int)>& body) {
  if (count <= 0) return;
  grain = std::max(1, grain);
  const int pieces = (count + grain - 1) / grain;
  const int threads = std::min(resolve_num_threads(num_threads), pieces);
  std::atomic<int> next{0};
  std::mutex failure_mutex;
  int failed_piece = pieces;
  std::exception_ptr failure;
  const auto work = [&](int thread) {
    for (int piece = next++; piece < pieces; piece = next++) {
      try {
        body(piece * grain, std::min(count, (piece + 1) * grain), thread);
      } catch (...) {
        next = pieces;  // those before this one have begun, so that the first failure is found
        const std::lock_guard<std::mutex> lock(failure_mutex);
        if (piece < failed_piece) failure = std::current_exception();
        failed_piece = std::min(failed_piece, piece);
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    helpers.reserve(static_cast<std::size_t>(threads - 1));
    for (int thread = 1; thread < threads; ++thread) helpers.emplace_back(work, thread);
    work(0);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace bpa
