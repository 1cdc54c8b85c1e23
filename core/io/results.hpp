// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/result/interpretation.hpp"

// Files of results. The CSV is the BOP benchmark's (scene_id, im_id, obj_id, score, R, t, time;
// millimetres) and holds the best interpretation. Our JSON holds all of them.

namespace bpa::io {

/// How a server answered for one frame. Files of bpa-client have it.
struct ServerAnswer {
  Status status;           ///< Why the frame was not searched; ok when it was.
  int queue_position = 0;  ///< Frames and requests that waited before this one; 0: none.
};

/// What was found in one frame of a data set.
struct FrameResult : SceneInterpretations {
  int scene_id = 0;    ///< 0 for a frame of no data set.
  int im_id = 0;       ///< 0 for a frame of no data set.
  double seconds = 0;  ///< Time spent on the whole frame.
  /// Empty: the detector ran in this process.
  std::optional<ServerAnswer> server;
};

/// Writes the best interpretations; a score is a placement's probability. Fails with unavailable.
Status write_results_csv(const std::string& path, const std::vector<FrameResult>& results);

/// Reads one interpretation per frame, frames by (scene_id, im_id); a CSV has no frame without
/// finds. Keeps scores outside [0, 1]. Fails with not_found, or corrupt naming file, line, column.
Result<std::vector<FrameResult>> read_results_csv(const std::string& path);

/// Writes everything; numbers survive to the last bit. Fails with unavailable.
Status write_results_json(const std::string& path, const std::vector<FrameResult>& results);
/// Reads what write_results_json wrote. Fails with not_found, or with corrupt naming the file.
Result<std::vector<FrameResult>> read_results_json(const std::string& path);

/// The text of such a file.
std::string results_json(const std::vector<FrameResult>& results);

/// One frame of a result file as one line of JSON, without a line break.
std::string result_json_line(const FrameResult& result);

}  // namespace bpa::io
