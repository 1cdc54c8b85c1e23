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

}  // namespace bpa::eval
