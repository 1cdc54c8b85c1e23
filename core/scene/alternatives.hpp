// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/detect/candidate.hpp"
#include "core/score/competition.hpp"

namespace bpa {

/// The other poses in which the object of candidate `chosen` explains the same view, by falling
/// weight: a mug with its handle out of sight, a box with one visible face. They are its rivals of
/// the same model; nearly equal poses are merged. Their weights and the chosen pose's own sum to 1.
/// Leaves out weights below `min_weight`. Empty if the view determines the pose.
std::vector<PoseAlternative> alternatives_of(const std::vector<Candidate>& candidates,
                                             const Competition& competition, std::size_t chosen,
                                             double min_weight = 0.02);

}  // namespace bpa
