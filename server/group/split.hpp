// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

// How the work of searches is spread over workers. No function looks at a clock.

namespace bpa::server::group {

/// The number of `workers` that each of `frames` gets: all for one frame, one each for many. At
/// least 1.
std::size_t workers_for_frame(std::size_t frames, std::size_t workers);

/// Which worker searches for each of `models`: `pace` is each worker's milliseconds for a model.
/// The slowest share takes as short as it can.
std::vector<std::size_t> split_models(std::size_t models, const std::vector<double>& pace);

}  // namespace bpa::server::group
