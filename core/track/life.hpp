// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result/placement.hpp"
#include "core/result/track.hpp"
#include "core/track/follow.hpp"

namespace bpa::track {

/// A track from birth to end.
struct Life {
  std::uint64_t id = 0;
  std::string name;
  Body body;
  double evidence = 0;  ///< Log odds that the object is there: the mean of the last searches'.
  int searches = 0;     ///< That found it or should have.
  bool sure = false;    ///< Confirmed.
  TrackState state = TrackState::tentative;
  int found = 0;                          ///< Searches that found it.
  std::int64_t found_ns = 0;              ///< Stamp of the frame of the last of them.
  int missed = 0;                         ///< Searches in a row that should find it and did not.
  int absent = 0;                         ///< Frames in a row.
  std::int64_t born_ns = 0, seen_ns = 0;  ///< Stamps.
  bool held = false;
  std::string ends = {};  ///< Why; empty: it lives.

  /// A search of the frame of this stamp has found the object. It may say so more than once.
  void believe(const Placement& placement, std::int64_t stamp);

  /// A search should have found the object and did not, which has these log odds.
  void doubt(double log_odds);

  /// What a search says of the pose of an object that is seen: one of the modes is right, and there
  /// are others. `now_from_then` takes poses of the search's camera to where the object is now.
  void suggest(const Placement& placement, const Pose& now_from_then);

  /// Makes sure of an object that is seen, by one placement of `min_probability` or by two, until
  /// it is more likely not to be there. Returns whether it did.
  bool confirm(double min_probability);

 private:
  void judge(double log_odds);
};

/// As the newest frame's result has it.
Track report(const Life& life, std::int64_t stamp_ns);

}  // namespace bpa::track
