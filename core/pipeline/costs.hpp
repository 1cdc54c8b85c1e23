// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <mutex>

namespace bpa {

/// What parts of a search cost in this process. Until they have run, shares are work: of the points
/// and poses that a part handles.
struct Costs {
  double preparation_ms = 0;   ///< Of a whole preparation of this frame; 0: not known.
  double round_share = 0.095;  ///< A whole round for one model, of the whole preparation.
  double final_share = 0.16;   ///< The final stages for one model, of the same.
};

/// Measures them, frame by frame. Any thread may call it.
class CostMeter {
 public:
  /// For a frame of so many pixels on so many threads. The first call takes a few milliseconds: it
  /// times a small frame.
  Costs costs(std::size_t pixels, int threads);
  /// What a frame took; a cost of 0 was not measured.
  void add(std::size_t pixels, int threads, const Costs& measured);

 private:
  struct Means {
    double preparation_us_per_pixel = 0;
    Costs shares = {};
  };
  std::mutex mutex_;
  std::map<int, Means> means_;  // by threads
};

}  // namespace bpa
