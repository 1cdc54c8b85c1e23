// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

// How the work of searches is spread over workers. No function looks at a clock.

namespace bpa::server::group {

/// What the search of one share costs, measured. Before that: two cores of a 2.5 GHz EPYC.
struct SearchCost {
  double preparation_ms = 60;  ///< Of the frame, by each worker that takes part.
  double ms_a_model = 15;      ///< Of one worker, after that.
  double exchange_ms = 20;     ///< On the wire.

  /// With the models split over so many workers.
  double milliseconds(std::size_t models, std::size_t workers) const {
    return preparation_ms +
           ms_a_model * static_cast<double>(models) / static_cast<double>(workers) +
           (workers > 1 ? exchange_ms : 0);
  }
  /// Moves towards what one more share took.
  void add(const SearchCost& measured);
};

/// The number of `workers` that each of `frames` should get, so that the last is answered first:
/// all for one frame, one each for many. At least 1.
std::size_t workers_for_frame(const SearchCost& cost, std::size_t models, std::size_t frames,
                              std::size_t workers);

/// Which worker searches for each of `models`: `pace` is each worker's milliseconds for a model.
/// The slowest share takes as short as it can.
std::vector<std::size_t> split_models(std::size_t models, const std::vector<double>& pace);

}  // namespace bpa::server::group
