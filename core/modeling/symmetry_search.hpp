// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/cloud/point_cloud.hpp"
#include "core/geometry/symmetry.hpp"

namespace bpa::modeling {

/// The rotations that map a surface onto itself: turns of a half to a sixth, and continuous ones.
/// At least 98 % of the points must fit within max(1.5 mm, 1.2 % of `diameter`). Where turns of
/// several orders together are as fine as 24 degrees, 95 % suffice for a continuous one. Normals
/// count, colours do not. The points must be evenly spaced; parts may be missing. Deterministic.
SymmetryGroup find_symmetries(const PointCloud& surface, double diameter, int num_threads);

/// One line for people: "any turn about (0, 0, 1) through (0, 0, 12) mm; 3 single turns".
std::string describe(const SymmetryGroup& group);

}  // namespace bpa::modeling
