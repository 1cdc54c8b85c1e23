// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/result/track.hpp"
#include "core/track/association.hpp"
#include "core/track/follow.hpp"

namespace bpa::track {

/// What the tracker remembers of a frame, for results of searches that come later.
struct FrameRecord {
  std::int64_t stamp_ns = 0;
  Pose frame_from_camera;
  std::vector<TrackRecord> tracks;
  std::vector<float> depths;  ///< sampled_depths() of the whole frame.
};

/// A frame that new objects are followed through.
struct KeptFrame {
  std::shared_ptr<const Frame> frame;
  Pose frame_from_camera;
};

/// A track from birth to end.
struct Life {
  std::uint64_t id = 0;
  std::string name;
  Body body;
  double evidence = 0;  ///< Log odds that the object is there, by the searches.
  TrackState state = TrackState::tentative;
  double most_probable = 0;               ///< Of the placements that found it.
  int found = 0;                          ///< Searches that found it.
  std::int64_t found_ns = 0;              ///< Stamp of the frame of the last of them.
  int missed = 0;                         ///< Searches in a row that should find it and did not.
  int absent = 0;                         ///< Frames in a row.
  std::int64_t born_ns = 0, seen_ns = 0;  ///< Stamps.
  bool held = false;
  std::string ends = {};  ///< Why; empty: it lives.
};

}  // namespace bpa::track
