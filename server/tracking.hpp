// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "server/busy.hpp"
#include "server/object_tracker.hpp"
#include "server/options.hpp"
#include "server/shared_frame.hpp"
#include "server/sources/frame_source.hpp"
#include "server/tf_buffer.hpp"
#include "server/tracking_statistics.hpp"

// Follows objects from frame to frame, beside the search, on a thread of its own.

namespace bpa::server {

/// A frame on its way to the tracker.
struct TrackingFrame {
  std::shared_ptr<SharedFrame> frame;
  std::int64_t stamp_ns = 0;
  std::string frame_id;
  WaitableClock::TimePoint arrived{};  ///< When its last byte had come.
};

/// What Tracking needs of the server.
struct TrackingLinks {
  std::function<bool()> wanted;                        ///< Whether a topic of tracks has a reader.
  std::function<void(const TrackedFrame&)> on_tracks;  ///< Runs on the tracking thread.
  std::function<std::int64_t()> stamp_now = unix_time_ns;  ///< Time as frames' stamps have it.
  LogHook log = {};
};

class Tracking {
 public:
  Tracking(std::unique_ptr<ObjectTracker> tracker, const TrackingOptions& options,
           TrackingLinks links);
  ~Tracking();
  Tracking(const Tracking&) = delete;
  Tracking& operator=(const Tracking&) = delete;

  /// Whether frames are followed now: tracking is on, and a topic of tracks has a subscriber or had
  /// one in the last linger_s.
  bool active() const;

  /// Takes a frame or counts why not; never waits. When too many wait, the oldest goes that the
  /// search has not begun with.
  void push(TrackingFrame frame);
  /// Takes the result of a search in a frame of the stream, or a part of it; the next frame carries
  /// it forward.
  void add(const SceneInterpretations& found);
  /// Whether the scene stands still since it was searched, at most rest_s ago: no need to search it
  /// again.
  bool rests() const;
  /// Where the confirmed tracks are in the newest frame of this camera; nothing where none is
  /// followed now.
  std::optional<std::vector<ExpectedPlacement>> expected(const std::string& frame_id) const;

  /// Each gives the track's id. `track` is its name, or its id in decimal digits. Fail with
  /// not_found, and with invalid_argument on a name that breaks a rule.
  Result<std::uint64_t> rename(const std::string& track, const std::string& name);
  Result<std::uint64_t> hold(const std::string& track, bool held);
  Result<std::uint64_t> forget(const std::string& track);

  void set_options(const TrackingOptions& options);
  /// Where transforms of /tf go; unused without a fixed frame.
  TfBuffer& transforms() { return transforms_; }

  TrackingCounts counts() const;
  SourceReport report() const;
  const Busy& busy() const { return busy_; }

 private:
  /// Why a frame was not followed, for the counts and in words.
  struct Refusal {
    Unfollowed cause;
    Status why;
  };

  void run(const std::stop_token& stop);
  void follow(const std::stop_token& stop, const TrackingFrame& item,
              const std::vector<SceneInterpretations>& results, const TrackingOptions& options);
  std::optional<Refusal> try_follow(const std::stop_token& stop, const TrackingFrame& item,
                                    const std::vector<SceneInterpretations>& results,
                                    const TrackingOptions& options, TrackedFrame& tracked);
  std::optional<Refusal> take_camera(const TrackingFrame& item);
  bool is_active() const;
  void note(const TrackingFrame& item, const TrackedFrame& tracked);
  void note(const Refusal& refusal);
  Result<std::uint64_t> id_of(const std::string& track) const;
  Status check_name(const std::string& name) const;

  const TrackingLinks links_;
  TfBuffer transforms_;
  Busy busy_;

  std::mutex tracker_mutex_;  ///< Held while the tracker works; taken before mutex_.
  const std::unique_ptr<ObjectTracker> tracker_;

  // Of the tracking thread alone.
  std::string camera_;                      ///< frame_id of the camera that is followed.
  WaitableClock::TimePoint camera_seen_{};  ///< When its last frame came.
  std::int64_t last_stamp_ns_ = 0;          ///< Of the last frame that was followed.

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  TrackingOptions options_;
  std::deque<TrackingFrame> queue_;
  bool working_ = false;                       ///< On a frame that is no longer in the queue.
  std::vector<SceneInterpretations> results_;  ///< For the next frame; at most kMaxResults.
  mutable std::optional<WaitableClock::TimePoint> last_wanted_;
  TrackingCounts counts_;
  track::TrackerCounts tracker_counts_;
  std::vector<std::pair<std::uint64_t, std::string>> tracks_;  ///< Id and name.
  std::string tracked_camera_;                                 ///< Of `expected_`.
  std::vector<ExpectedPlacement> expected_;
  std::int64_t searched_ns_ = 0;  ///< Stamp of the frame that was searched last, and
  std::optional<WaitableClock::TimePoint> searched_at_;  ///< when its result came.
  double changed_share_ = 1;                             ///< Of the depths, since then.
  std::deque<WaitableClock::TimePoint> followed_at_;     ///< In the last 10 s.
  Latencies from_arrival_, from_stamp_, working_ms_;
  std::optional<Refusal> trouble_;  ///< Why the last frame was not followed.

  std::jthread thread_;  ///< Last: uses what stands above.
};

}  // namespace bpa::server
