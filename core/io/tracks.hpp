// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/result/track.hpp"

namespace bpa::io {

/// The tracks after one frame of a data set.
struct TrackResult : TrackedFrame {
  int scene_id = 0;  ///< 0 for a frame of no data set.
  int im_id = 0;     ///< 0 for a frame of no data set.
};

/// Writes everything as JSON; numbers survive to the last bit. Fails with unavailable.
Status write_tracks_json(const std::string& path, const std::vector<TrackResult>& frames);
/// Reads what write_tracks_json wrote. Fails with not_found, or with corrupt naming the file.
Result<std::vector<TrackResult>> read_tracks_json(const std::string& path);
/// One frame as one line of JSON, without a line break.
std::string track_json_line(const TrackResult& frame);

}  // namespace bpa::io
