// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/base/random.hpp"
#include "core/sim/render.hpp"

// What piles and sequences draw by chance, and where the scenery lies in a stage.

namespace bpa::sim {

// Places in Stage::scenery().
constexpr int kRoom = 0, kBin = 1, kFirstTable = 2, kNumTables = 4, kFirstDistractor = 6,
              kNumDistractors = 12;

/// A turn about the vertical.
Eigen::Quaterniond turned(RandomStream& random);
/// Upright with a chance of 0.3, else uniform over all orientations.
Eigen::Quaterniond start_rotation(RandomStream& random);
/// `count` of the numbers below `from`, in random order; all of them where there are fewer.
std::vector<int> chosen_without_repetition(int count, int from, RandomStream& random);
/// Two lamps and the ambient light, without materials.
Shading draw_shading(RandomStream& random);

}  // namespace bpa::sim
