// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/detect/candidate.hpp"

// Which placements cannot both be there. Equal objects may lie side by side, stacked or nested, so
// near centres alone exclude nothing.

namespace bpa::detect {

/// Share of the smaller one's pixels that two placements may share. Chosen by hand.
constexpr double kMaxShared = 0.3;

/// Whether two placements cannot both be there: they share more than kMaxShared of their pixels, or
/// collide. `common`: how many of Candidate::explained both have.
bool exclude(const Candidate& a, const Candidate& b, int common);

/// How many numbers two rising sequences have in common.
int common_pixels(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second);

/// Whether two placements fill the same space: more than a tenth of one's surface lies over 1 cm
/// inside the other. Equal models collide too where their centres are nearer than half their
/// thickness (by hand). Models that are 2 cm thin, or were seen from one side, have no such inside:
/// they collide where their centres are too near for two objects.
bool collide(const Candidate& a, const Candidate& b);

}  // namespace bpa::detect
