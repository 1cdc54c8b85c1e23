// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <bpa/types.hpp>

namespace bpa::cli {

/// Prints the ranked interpretations for people: the best one in full, of the next ones what
/// differs.
void print_detections(const DetectionSet& set, int max_interpretations);

/// Clears the terminal. Prints the frame, the results per second and the best interpretation as a
/// table with one object a line.
void print_table(const DetectionSet& set, double frames_per_second);

/// Writes a result file as `bpa detect --json` does; nothing for an empty path.
void write_results(const std::string& path, const std::vector<DetectionSet>& sets);

}  // namespace bpa::cli
