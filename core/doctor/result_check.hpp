// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/cloud/frame.hpp"
#include "core/doctor/finding.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::doctor {

/// Whether a result is empty or doubtful: it has no placement, or none of a presence of 0.5.
bool says_little(const SceneInterpretations& result);

/// Findings as one line each, the worst first: "WHAT: WHY. REMEDY".
std::string lines_of(Findings findings);

/// What check_frame() finds in a frame whose result says little, as lines; else empty.
std::string advice_on(const Frame& frame, const SceneInterpretations& result, double max_range_m,
                      int num_threads = 1);

}  // namespace bpa::doctor
