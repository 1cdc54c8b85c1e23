// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "core/eval/pose_errors.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/model/object_model.hpp"

namespace bpa::eval {

/// The cost of a pair that cannot be matched.
constexpr double kNoMatch = std::numeric_limits<double>::infinity();

/// The larger of position error / position_m and orientation error / angle_rad, modulo the symmetry
/// (paper section VII): 0 to 1, and kNoMatch above 1.
double right_cost(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry,
                  double position_m = kPoseTolerance_m, double angle_rad = kPoseTolerance_rad);

/// Whether a pose of a model (camera_from_object) is_right() about one of these instances.
bool is_right_about_any(const Pose& estimate, const ObjectModel& model,
                        const std::vector<io::BopInstance>& truth);

/// Greedy one-to-one matching, as BOP does it: estimates by falling score (by index where equal)
/// each take the free truth of the smallest cost below `limit`. costs[e][t] is kNoMatch where the
/// estimate is not correct for the truth. Returns the truth of each estimate, -1 for none.
std::vector<int> match_greedily(const std::vector<double>& scores,
                                const std::vector<std::vector<double>>& costs,
                                double limit = kNoMatch);

}  // namespace bpa::eval
