// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"
#include "core/eval/evaluation.hpp"

namespace bpa::draw {

/// Writes recall.png, precision_recall.png and false_positives.png (over the least probability),
/// reliability.png, coverage.png, reports.png (true and false positives by probability),
/// visible_fraction.png, visible_histogram.png, distance.png, objects.png and time.png. Fails with
/// unavailable.
Status write_plots(const std::string& folder, const eval::EvaluationReport& report);

}  // namespace bpa::draw
