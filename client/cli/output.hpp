// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

namespace bpa::cli {

/// The ranked interpretations for people: the best one in full, of the next ones what differs.
void print_detections(std::ostream& out, const DetectionSet& set, int max_interpretations);

/// The best interpretation as a table, a line for each object, under a line about the frame and how
/// many come each second.
void print_table(std::ostream& out, const DetectionSet& set, double frames_per_second);

/// Writes a result file as `bpa detect --json` does; nothing for an empty path. Fails with
/// unavailable.
Status write_results(const std::string& path, const std::vector<DetectionSet>& sets);

}  // namespace bpa::cli
