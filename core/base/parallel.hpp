// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace bpa {

/// The number of threads meant by `num_threads`: itself if positive, else one per core.
int resolve_num_threads(int num_threads);

/// Calls `body(first, last, thread)` for consecutive pieces of [0, count), of at most `grain` items
/// each. Runs on up to `num_threads` threads (0 = one per core), including the caller's. Which
/// `thread` in [0, num_threads) takes a piece varies: write results by index and reduce in index
/// order, and the answer does not depend on `num_threads`. When `body` throws, no further piece
/// begins, and the caller gets the exception of the lowest index.
void parallel_for_pieces(int count, int grain, int num_threads,
                         const std::function<void(int first, int last, int thread)>& body);

/// Calls `body(index)` for every index in [0, count), in pieces of some sixteen for each thread;
/// see parallel_for_pieces.
template <class Index, class Body>
void parallel_for(Index count, int num_threads, const Body& body) {
  const int items = static_cast<int>(count);
  const int grain = items / (16 * resolve_num_threads(num_threads));
  parallel_for_pieces(items, grain, num_threads, [&body](int first, int last, int) {
    for (int i = first; i < last; ++i) body(static_cast<Index>(i));
  });
}

/// Calls `body(index)` for every index in [0, count): on the caller's thread, and on those threads
/// of the parallel_for_pieces() around this call that have nothing left to do. Alone on the
/// caller's thread without one around it. As there, write results by index; when `body` throws, no
/// further index begins, and the caller gets the exception of the lowest index.
void parallel_for_spare(int count, const std::function<void(int index)>& body);

/// Calls both, each with its share of `num_threads` (0 = one per core). At the same time where that
/// is not 1.
inline void run_both(int num_threads, const std::function<void(int threads)>& first,
                     const std::function<void(int threads)>& second) {
  const int all = resolve_num_threads(num_threads), half = all / 2;
  parallel_for_pieces(2, 1, all, [&](int k, int, int) {
    if (k == 0) {
      first(all - half);
    } else {
      second(half > 0 ? half : 1);
    }
  });
}

}  // namespace bpa
