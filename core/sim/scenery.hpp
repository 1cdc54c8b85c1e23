// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/sim/objects.hpp"

// What stands round the objects.

namespace bpa::sim {

constexpr double kTableHalfX = 0.6;  ///< Metres; the top is at z = 0.
constexpr double kTableHalfY = 0.45;
constexpr double kFloorHeight = -0.72;

constexpr double kBinHalfX = 0.19;
constexpr double kBinHalfY = 0.14;

/// Tables with different tops.
std::vector<SimulatedObject> make_tables();
/// Floor and walls of a room of 5 m.
SimulatedObject make_room();
/// A low open box that stands on the table; it does not move.
SimulatedObject make_bin();
/// A round plate for turning objects, its top at z = 0.
SimulatedObject make_turntable_plate(double radius, double height);
/// Objects that are not among the household objects.
std::vector<SimulatedObject> make_distractors(int num_threads);

}  // namespace bpa::sim
