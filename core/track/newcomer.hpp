// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/result/placement.hpp"
#include "core/track/follow.hpp"
#include "core/track/history.hpp"

namespace bpa::track {

/// A placement of an earlier frame on its way to the newest one. First it is tried where it was. If
/// it has moved, the frames since are gone through, a few in each step: a camera's next frame does
/// not wait for that. Where its own pose is not there, its alternatives are tried in turn.
class Newcomer {
 public:
  enum class Progress : std::uint8_t { on_the_way, arrived, gone };

  /// `track`: the id of the track that it shows, which is not seen now; 0: a new one. `then` is the
  /// placement's frame.
  Newcomer(Placement found, std::shared_ptr<const ObjectModel> model, std::uint64_t track,
           const FrameRecord& then);

  /// Goes through at most `most` of the frames since, and on to the newest if these were the last.
  Progress step(std::span<const KeptFrame> since, const ObservedFrame& newest, std::size_t most);

  std::uint64_t track() const { return track_; }
  const Placement& found() const { return found_; }
  const ObjectModel& model() const { return *model_; }
  std::int64_t stamp_ns() const { return stamp_ns_; }  ///< Of its frame.
  std::int64_t at_ns() const { return at_ns_; }        ///< Of the frame that it has come to.
  /// Of its frame's camera, in the tracks' frame of reference.
  const Pose& frame_from_camera() const { return frame_from_camera_; }
  /// Where it was in its frame, in the tracks' frame of reference.
  Pose start() const { return frame_from_camera_ * found_.frame_from_object; }
  /// What takes poses of its camera then to where the object is now, once it has arrived.
  Pose now_from_then() const { return body_->motion.pose() * tried_pose_.inverse(); }
  /// Where it has arrived, with its alternatives as modes.
  Body take_body();

 private:
  void begin();

  Placement found_;  ///< In the camera frame.
  std::shared_ptr<const ObjectModel> model_;
  std::uint64_t track_;
  std::int64_t stamp_ns_;
  Pose frame_from_camera_;
  std::size_t tried_ = 0;  ///< Of its own pose and its alternatives.
  Pose tried_pose_;        ///< The one that is on its way, in the camera's frame then.
  std::optional<Body> body_;
  std::int64_t at_ns_;
};

/// Adds a placement's alternatives to a body. `now_from_then` moves poses of its frame to where the
/// object is now.
void add_alternatives(const Placement& found, const Pose& now_from_then, Body& body);

}  // namespace bpa::track
