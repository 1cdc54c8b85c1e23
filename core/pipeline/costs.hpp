// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <utility>

namespace bpa {

/// What parts of a search cost in this process. Until they have run, shares are those of 21 models
/// on YCB-Video's frames.
struct Costs {
  double preparation_ms = 0;   ///< Of a whole preparation of a frame; 0: not known.
  double round_share = 0.095;  ///< A whole round for one model, of the whole preparation.
  double final_share = 0.16;   ///< The final stages for one model, of the same.
};

/// Measures them, frame by frame. Any thread may call it.
class CostMeter {
 public:
  /// For frames of so many pixels on so many threads. The first call takes some milliseconds: it
  /// times small frames.
  Costs costs(std::size_t pixels, int threads);
  /// What a frame took; a cost of 0 was not measured.
  void add(std::size_t pixels, int threads, const Costs& measured);

 private:
  std::mutex mutex_;
  std::map<std::pair<std::size_t, int>, Costs> means_;  // by pixels and threads
};

}  // namespace bpa
