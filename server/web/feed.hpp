// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/io/results.hpp"
#include "core/result/track.hpp"
#include "server/shared_frame.hpp"
#include "server/web/shown_frame.hpp"

namespace bpa::server::web {

/// The newest frame of the camera.
struct CameraFrame {
  std::uint64_t id = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t came_ns = 0;  ///< When it came in, by the server's clock.
  std::string frame_id;
  std::shared_ptr<ShownFrame> shown;
};

/// A search that viewers may look at.
struct KeptResult {
  std::uint64_t id = 0;      ///< From 1, rising.
  std::string origin;        ///< "camera", or what was asked for: "region", "upload", "next frame".
  std::string advice;        ///< What the doctor says of the frame; empty: nothing.
  std::int64_t came_ns = 0;  ///< When it was there, by the server's clock.
  Camera camera;
  std::shared_ptr<ShownFrame> shown;
  io::FrameResult result;

  /// Everything; made once for all viewers. Thread-safe.
  const std::string& json() const;
  std::string summary() const;  ///< JSON for the time line: objects, times of the stages.

 private:
  mutable std::once_flag json_made_;
  mutable std::string json_;
};

struct FeedCounts {
  std::uint64_t viewers = 0;        ///< Now.
  std::uint64_t viewers_gone = 0;   ///< Stopped asking: left, or does not read.
  std::uint64_t frames_unseen = 0;  ///< Of the camera, displaced before any viewer heard of them.
};

/// What the server has for viewers: the camera's newest frame, the last results, the tracks. While
/// no viewer has asked for 5 s, nothing is kept or copied. Thread-safe.
class Feed {
 public:
  using Clock = std::chrono::steady_clock;
  /// A viewer asks again within 2 s; one that does not read its answers cannot.
  static constexpr std::chrono::seconds kViewerPatience{5};

  /// Keeps `history` results; `now_ns` is the time as frames' stamps have it.
  Feed(std::size_t history, std::function<std::int64_t()> now_ns)
      : history_(history), now_ns_(std::move(now_ns)) {}

  /// Whether a viewer has asked in the last 5 s.
  bool wanted() const;
  /// The same of tracks.
  bool tracks_wanted() const;

  // Of the server; they do nothing while nobody looks.
  void add_frame(std::shared_ptr<SharedFrame> frame, std::int64_t stamp_ns,
                 const std::string& frame_id);
  /// `advice` as of KeptResult.
  void add_result(const Frame& frame, const SceneInterpretations& result,
                  const std::string& advice = {});
  void add_tracks(const TrackedFrame& tracks);

  /// Keeps the result of what a viewer asked for, for 5 s at least, and returns its id.
  std::uint64_t add_asked(const Frame& frame, const SceneInterpretations& result,
                          std::string origin, const std::string& advice = {});

  /// Notes that a viewer asks. The result `held`, 0 for none, is kept until this viewer holds
  /// another or is gone. `busy` when there are as many viewers as may be.
  Status see(const std::string& viewer, bool tracks, std::uint64_t held = 0);
  /// Called after each change, on the thread that caused it; empty: nobody.
  void on_change(std::function<void()> changed);

  /// Grows with every change.
  std::uint64_t sequence() const { return sequence_; }
  std::optional<CameraFrame> camera_frame() const;
  /// The frame of this id, or the next that is still kept.
  std::optional<CameraFrame> camera_frame(std::uint64_t id) const;
  /// By rising id; those after `id`.
  std::vector<std::shared_ptr<const KeptResult>> results_after(std::uint64_t id) const;
  /// The same for a viewer that is told of them. The last is kept until the viewer is told of a
  /// later one or is gone: what a viewer may show is not dropped before it can say so.
  std::vector<std::shared_ptr<const KeptResult>> tell(const std::string& viewer, std::uint64_t id);
  /// Null where it is no longer kept.
  std::shared_ptr<const KeptResult> result(std::uint64_t id) const;
  /// JSON; empty without tracks.
  std::string tracks() const;
  /// Forgets viewers that are gone, and all that was kept once none is left.
  void tidy();
  FeedCounts counts() const;

 private:
  struct Viewer {
    Clock::time_point seen{};
    std::uint64_t held = 0, told = 0;  ///< Results' ids; 0: none.
  };

  std::uint64_t add(const Frame& frame, const SceneInterpretations& result, std::string origin,
                    const std::string& advice = {});
  void keep(std::shared_ptr<KeptResult> kept);
  void changed();

  const std::size_t history_;
  const std::function<std::int64_t()> now_ns_;
  std::atomic<std::uint64_t> sequence_{1};
  std::atomic<Clock::rep> last_seen_{0}, last_saw_tracks_{0};  ///< Of any viewer; 0: never.
  std::mutex change_mutex_;  ///< Held while on_change_ runs, so that it can be taken away.
  std::function<void()> on_change_;
  mutable std::mutex mutex_;
  std::map<std::string, Viewer> viewers_;
  std::uint64_t viewers_gone_ = 0, frames_unseen_ = 0;
  std::deque<CameraFrame> frames_;  ///< The newest last.
  mutable bool frame_seen_ = true;  ///< A viewer heard of the newest.
  std::deque<std::shared_ptr<const KeptResult>> results_;
  std::uint64_t next_frame_ = 1, next_result_ = 1;
  std::optional<TrackedFrame> tracks_;
};

}  // namespace bpa::server::web
