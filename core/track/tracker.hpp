// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"
#include "core/result/track.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::track {

struct TrackerOptions {
  BPA_OPTION(double, min_probability, 0.5, (0, 1).at_run_time(),
             "Objects that are there with at least this probability begin a track.");
  BPA_OPTION(
      double, min_confirming, 0.8, (0, 1).at_run_time(),
      "A track is confirmed by one search that finds the object with this probability, or by two.");
  BPA_OPTION(double, lost_s, 10, (0.1, 3600).at_run_time(),
             "Seconds after which a track that is not seen ends, unless it is held.");
  BPA_OPTION(double, hidden_s, 30, (0.1, 86400).at_run_time(),
             "The same of a track that nearer surface hides, or that is outside of the image.");
  BPA_OPTION(int, num_threads, 0, (0, 256).at_run_time(),
             "0: one per core. Does not change the answer.");
};

/// Where the camera is, in a frame that stands still.
struct CameraPose {
  std::string frame_id;  ///< Of the fixed frame.
  Pose fixed_from_camera;
};

/// Since the tracker was made.
struct TrackerCounts {
  std::uint64_t frames = 0;     ///< Followed.
  std::uint64_t births = 0;     ///< Tracks begun.
  std::uint64_t confirmed = 0;  ///< Tracks that were confirmed.
  std::uint64_t losses = 0;     ///< Times that a track was lost.
  std::uint64_t found_again = 0;
  std::uint64_t ends = 0;            ///< Tracks ended.
  std::uint64_t searches = 0;        ///< Results of searches taken.
  std::uint64_t stale_searches = 0;  ///< Results refused: their frame is no longer remembered.
};

/// Follows objects through the frames of one camera. Not thread-safe. The same frames, stamps and
/// results in the same order give the same tracks.
class Tracker {
 public:
  Tracker(std::shared_ptr<const ModelLibrary> library, TrackerOptions options,
          score::ScoreLayers layers = score::default_score_layers());
  ~Tracker();

  /// Moves every track to this frame. Stamps must rise: fails with invalid_argument on a frame that
  /// is not newer than the last, or not valid. A camera that has a pose in one frame and none in
  /// the next begins anew: all tracks end.
  Result<TrackedFrame> track(std::shared_ptr<const Frame> frame,
                             const std::optional<CameraPose>& camera = std::nullopt);

  /// Stamps may go back, as of a recording that repeats: all tracks end, for this reason. Ids go
  /// on; names are counted from 1 again.
  void begin_anew(const std::string& reason);

  /// Takes the result of a search in a frame that track() was given before. The next track()
  /// carries it forward. A partial one counts where it is sure (min_confirming), and finds what is
  /// not seen again; what it lacks counts for nothing. Fails with not_found on a frame that is no
  /// longer remembered.
  Status add(const SceneInterpretations& found);

  /// The share of depths that the newest frame has otherwise than an earlier one; 1 where that is
  /// not remembered. A scene that stands still before a camera that stands still need not be
  /// searched again.
  double changed_since(std::int64_t stamp_ns) const;

  /// Where the confirmed tracks are in the newest frame, for DetectRequest::expected.
  std::vector<ExpectedPlacement> expected() const;

  /// Fail with not_found, which lists the tracks there are; rename() with invalid_argument on a
  /// name that is empty or another track's.
  Status rename(std::uint64_t id, const std::string& name);
  Status hold(std::uint64_t id, bool held);
  Status forget(std::uint64_t id);

  const TrackerOptions& options() const;
  void set_options(const TrackerOptions& options);
  /// Tracks of models that the new library lacks end with the next frame.
  void set_library(std::shared_ptr<const ModelLibrary> library, score::ScoreLayers layers);
  const TrackerCounts& counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bpa::track
