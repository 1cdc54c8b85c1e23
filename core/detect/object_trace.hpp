// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/score/pose_check.hpp"

// What became of one model's hypotheses, for training, experiments and pictures. Whoever does not
// ask for it pays a test of a pointer where a pose is dropped.

namespace bpa {

/// Poses that were given up, all for one reason.
struct Dropped {
  const char* reason;  ///< For people: "200 are dropped: REASON".
  std::vector<FastPose> poses;
};
using DroppedPoses = std::vector<Dropped>;

/// Notes a pose that is given up; nothing without `trace`.
inline void drop(DroppedPoses* trace, const char* reason, const FastPose& pose) {
  if (!trace) return;
  auto found = std::find_if(trace->begin(), trace->end(),
                            [&](const Dropped& d) { return std::string_view(d.reason) == reason; });
  if (found == trace->end()) found = trace->insert(found, {reason, {}});
  found->poses.push_back(pose);
}

/// What became of everything that was sampled.
struct SamplingTrace {
  std::vector<FastPose> considered;  ///< Every pose that was looked at.
  DroppedPoses dropped;              ///< Of those; the rest was returned, perhaps corrected.
  double check_milliseconds = 0;     ///< The part of the time that checks and corrections took.
};

struct ObjectTrace {
  struct Stage {
    const char* name;
    std::vector<FastPose> poses;  ///< Still alive after the stage.
    double milliseconds = 0;
    /// Given up since the stage before: with `poses`, as many as were alive after that, but for
    /// "turned", which adds poses and gives up only such new ones.
    DroppedPoses dropped;
  };
  /// sampled, free_space, clusters, round_two, aligned, climbed, turned, final.
  std::vector<Stage> stages;
};

}  // namespace bpa
