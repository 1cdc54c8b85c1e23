// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace bpa::sim {

/// A row-major image of standard normal numbers, each pixel of variance 1. With `radius` > 0
/// neighbours resemble each other: white noise under a tent of half width `radius` + 1 pixels. The
/// same for any number of threads.
std::vector<float> noise_field(int width, int height, int radius, std::uint64_t seed,
                               int num_threads);

}  // namespace bpa::sim
