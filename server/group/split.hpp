// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

// How the work of searches is spread over workers. No function looks at a clock.

namespace bpa::server::group {

/// What one search costs, measured.
struct SearchCost {
  double preparation_ms = 60;  ///< Of the frame, by each worker that takes part.
  double search_ms = 3000;     ///< For all models by one worker.
  double exchange_ms = 20;     ///< Waiting for the slowest worker, and messages.

  /// With the models split over so many workers.
  double milliseconds(std::size_t workers) const {
    return preparation_ms + search_ms / static_cast<double>(workers) +
           (workers > 1 ? exchange_ms : 0);
  }
  /// Moves towards what one more search took.
  void add(const SearchCost& measured);
};

/// The number of `workers` that each of `frames` should get, so that the last is answered first:
/// all for one frame, one each for many. At least 1.
std::size_t workers_for_frame(const SearchCost& cost, std::size_t frames, std::size_t workers);

/// Which worker searches for each of `models`: `pace` is each worker's milliseconds for a model.
/// The slowest share takes as short as it can.
std::vector<std::size_t> split_models(std::size_t models, const std::vector<double>& pace);

}  // namespace bpa::server::group
