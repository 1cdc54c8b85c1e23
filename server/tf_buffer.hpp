// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/geometry/pose.hpp"
#include "idl/wire/msg/geometry_msgs.hpp"

// The transforms of /tf and /tf_static, as tf2 understands them: each frame has one parent at a
// time; between two stamps a transform is interpolated, outside of them it is not known.

namespace bpa::server {

/// What became of the transforms that came.
struct TfCounts {
  std::uint64_t taken = 0;
  std::uint64_t bad = 0;       ///< Refused: no finite numbers, no unit quaternion, no legal name.
  std::uint64_t loops = 0;     ///< Refused: the frame would be above itself.
  std::uint64_t full = 0;      ///< Refused: as many frames as may are known.
  std::uint64_t restarts = 0;  ///< A frame's stamps went back: its history began anew.
};

/// Thread-safe. Memory is bounded: kMaxFrames frames of kMaxSamples transforms each.
class TfBuffer {
 public:
  static constexpr std::size_t kMaxFrames = 1024;   ///< Those beyond are refused.
  static constexpr std::size_t kMaxSamples = 3000;  ///< Of one frame; the oldest goes.
  static constexpr std::size_t kMaxNameLength = 256;

  /// `keep_s`: how far back transforms are remembered, by their stamps.
  explicit TfBuffer(double keep_s) { set_keep(keep_s); }
  void set_keep(double keep_s);

  /// Takes a transform, or refuses and counts it: a quaternion off unit length by more than 1 %, a
  /// value that is not finite, a frame without a name, a loop. A leading '/' of a name is dropped.
  void add(const wire::geometry_msgs::TransformStamped& message, bool is_static);

  /// target_from_source at a time. Translations are interpolated linearly, rotations along the
  /// great circle. Fails with not_found where the frames are not connected, with unavailable where
  /// the time is later than the last transform or earlier than the first; the message names the
  /// frame.
  Result<Pose> lookup(const std::string& target, const std::string& source,
                      std::int64_t stamp_ns) const;
  /// The same; while it fails, waits for transforms until the time is over or `stop` is requested.
  Result<Pose> wait_for(const std::string& target, const std::string& source, std::int64_t stamp_ns,
                        std::chrono::nanoseconds timeout, const std::stop_token& stop) const;

  /// Whether a transform from or to this frame is known.
  bool knows(const std::string& frame) const;
  TfCounts counts() const;
  std::size_t frames() const;

 private:
  struct Sample {
    std::int64_t stamp_ns = 0;
    std::string parent;
    Pose parent_from_child;
  };
  struct History {
    bool is_static = false;
    std::deque<Sample> samples;  ///< By stamp; one of a static frame.
  };
  /// A frame's ancestors at a time, the frame first, with their poses of the frame.
  struct Chain {
    std::vector<std::pair<std::string, Pose>> ancestors;
    Status end;  ///< Why it goes no further; ok at a root.
  };

  bool makes_loop(const std::string& child, const std::string& parent) const;
  static Result<Sample> at(const std::string& child, const History& history, std::int64_t stamp_ns);
  Chain chain(const std::string& frame, std::int64_t stamp_ns) const;
  Result<Pose> find(const std::string& target, const std::string& source,
                    std::int64_t stamp_ns) const;

  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  std::int64_t keep_ns_ = 0;
  std::map<std::string, History> frames_;  ///< By child.
  TfCounts counts_;
};

}  // namespace bpa::server
