// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/detect/candidate.hpp"
#include "core/score/competition.hpp"

namespace bpa {

/// The other poses in which the object of candidate `chosen` explains the same view (a handle that
/// may be anywhere out of sight, a box of which one face is seen), by falling weight: its rivals of
/// the same model, those of nearly the same pose as one. With the chosen pose's own weight they sum
/// to 1; what weighs less than `min_weight` is left out. Empty when the view decides.
std::vector<PoseAlternative> alternatives_of(const std::vector<Candidate>& candidates,
                                             const Competition& competition, std::size_t chosen,
                                             double min_weight = 0.02);

}  // namespace bpa
