// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "core/sim/objects.hpp"

// Arms of a person: capsules and ellipsoids of skin and sleeve. They hide, push and hold objects,
// and are no object of a library.

namespace bpa::sim {

/// Places in make_arms().
constexpr int kStraightArm = 0, kFist = 1, kFirstGrip = 2, kNumGrips = 4, kNumArms = 6;

/// Clear widths between the fingers of the grips, metres.
constexpr std::array<double, kNumGrips> kGripWidths = {0.03, 0.05, 0.075, 0.105};
/// From the fingertips of a grip to its palm, metres.
constexpr double kGripDepth = 0.07;
constexpr double kFistRadius = 0.045;     ///< Metres.
constexpr double kForearmRadius = 0.045;  ///< Of the straight arm about its origin, metres.

/// - The straight arm lies along x and reaches at least 0.3 m from its origin to both sides.
/// - The fist is about its origin; its forearm goes up (-z) and back (+y).
/// - A grip points down (+z): the origin is between its fingertips, which close along x. Its
/// forearm
///   goes as the fist's.
std::vector<SimulatedObject> make_arms();

}  // namespace bpa::sim
