// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

namespace bpa::cli {

/// The ranked interpretations for people: the best one in full, of the next ones what differs.
void print_detections(std::ostream& out, const DetectionSet& set, int max_interpretations);

/// The best interpretation as a table, a line for each object, under a line about the frame and how
/// many come each second.
void print_table(std::ostream& out, const DetectionSet& set, double frames_per_second);

/// One frame of the project's result files (`bpa detect --json`).
nlohmann::json to_json(const DetectionSet& set);

/// Writes a result file: {"format": "bpa results", "version": 1, "frames": [...]}.
Status write_results(const std::string& path, const std::vector<DetectionSet>& sets);

/// Scene and image number of a frame_id such as "48/1"; 0, 0 for any other.
std::pair<int, int> scene_and_image(const std::string& frame_id);

}  // namespace bpa::cli
