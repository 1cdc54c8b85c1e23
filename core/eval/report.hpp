// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/eval/evaluation.hpp"

namespace bpa::eval {

/// The report as tables for people.
std::string report_text(const EvaluationReport& report);

/// The report as JSON; every ratio with its counts.
std::string report_json(const EvaluationReport& report);

/// Writes recall.png, reliability.png, coverage.png, reports.png (right and false ones by
/// probability), visible_fraction.png, visible_histogram.png, distance.png, objects.png and
/// time.png.
Status write_plots(const std::string& folder, const EvaluationReport& report);

}  // namespace bpa::eval
