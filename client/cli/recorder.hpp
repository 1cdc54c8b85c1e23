// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include <bpa/client.hpp>

namespace bpa::cli {

/// When a recorded frame came and what it was called.
struct RecordedFrame {
  double after_s = 0;  ///< Since the first one.
  std::int64_t stamp_ns = 0;
  std::string frame_id;
};

/// Takes down the frames that clients publish and what the server finds in them:
///
///   FOLDER/test/000001/{rgb,depth}/NNNNNN.png, scene_camera.json   BOP layout, for `bpa detect
///   --bop` FOLDER/recording.json                                          when each frame came,
///   its stamp FOLDER/results.json                                            as `bpa-client send
///   --json`
class Recorder {
 public:
  explicit Recorder(std::string folder) : folder_(std::move(folder)) {}

  /// Makes the folder, which must not exist yet, and listens from then on. The client must go
  /// before the recorder does, or be given to finish() while it is still there.
  Status start(Client& client);
  /// Writes what is known at the end; tells on the standard output how much there is. A file that
  /// could not be written is reported here.
  Status finish();

 private:
  void add(const FrameView& frame);
  Status write(const FrameView& frame, int number);

  const std::string folder_;
  std::mutex mutex_;
  bool finished_ = false;
  Status trouble_;  ///< The first.
  std::chrono::steady_clock::time_point first_;
  std::vector<RecordedFrame> frames_;
  std::vector<std::string> cameras_;  ///< Entries of scene_camera.json.
  std::vector<DetectionSet> results_;
};

/// Reads FOLDER/recording.json. `not_found` or `corrupt`.
Result<std::vector<RecordedFrame>> read_recording(const std::string& folder);

}  // namespace bpa::cli
