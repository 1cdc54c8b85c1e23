// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

// The report of bpa bench speed, which is JSON:
//
//   "format": "bpa speed bench", "version": 1
//   "bpa", "cpu", "dataset": texts; "threads", "seed", "frames": numbers
//   "budgets": a row for each time budget, "budget_s": seconds, null: none
//   "models": a row for each number of models, "models": searched for in each frame; "loaded": in
//     memory; "load_ms": time to load these; "peak_memory_mb": of loading and searching, 10^6
//     bytes; "found_when_given": instances found when the true poses are candidates from the start
//   "stages_ms": mean milliseconds of each stage without a budget
//
// A row has the placements "right" of those "reported"; instances "found" in the best
// interpretation and "found_in_twenty" of all "instances"; "median_ms" and "max_ms" of a frame; and
// means of a frame: "cpu_s" and the counts of SearchEffort. What the machine does not tell is null.

namespace bpa::cli {

using SpeedReport = nlohmann::ordered_json;

/// A report without rows.
SpeedReport empty_speed_report();

/// For people, to stdout.
void print_speed_report(const SpeedReport& report);

/// Draws recall over time, from the budgets. Fails with unavailable.
void plot_recall_over_time(const std::string& path, const SpeedReport& report);

}  // namespace bpa::cli
