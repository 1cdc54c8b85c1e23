// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/score/components.hpp"

// Log odds below which a candidate is given up. They are of the score layers that make the log
// odds, and lie in one file with them. `bpa train` does not measure them yet: it keeps those of the
// layers that it starts from.

namespace bpa {

/// Where the search compares a candidate's log odds with a limit.
enum class Limit : std::uint8_t {
  ranked,     ///< A pose from features or pairs goes on to clustering.
  clustered,  ///< A cluster goes on to round two.
  aligned,    ///< A pose is aligned to the end.
  refined,    ///< An aligned pose is scored with all components.
  repeated,   ///< A pose that an earlier round scored may be scored again.
  support,    ///< A model that was found with this searches the whole sample of later rounds.
  climbed,    ///< A placement climbs the score.
  turned,     ///< A placement is tried in near-symmetric poses.
  laid,       ///< A pose at rest on a flat region is moved and scored in full.
  compared,   ///< The best placement of a place is compared with its rivals.
  selected,   ///< A placement is returned.
  competing   ///< A placement competes for its pixels with others.
};
inline constexpr std::string_view kLimitNames[] = {
    "ranked",  "clustered", "aligned", "refined",  "repeated", "support",
    "climbed", "turned",    "laid",    "compared", "selected", "competing"};
inline constexpr std::size_t kLimits = std::size(kLimitNames);

/// The limits that one search runs with.
struct Limits {
  std::array<double, kLimits> stages{};  ///< Log odds, by Limit.
  /// Log odds of the components up to and with this one (kScoreComponents): with lower ones a
  /// placement is measured no further. Minus infinity: no limit.
  std::array<double, kScoreComponents.size()> components{};

  /// Nothing is given up.
  static Limits none() {
    Limits out;
    out.stages.fill(-std::numeric_limits<double>::infinity());
    out.components.fill(-std::numeric_limits<double>::infinity());
    return out;
  }
  double operator[](Limit limit) const { return stages[static_cast<std::size_t>(limit)]; }
  double& operator[](Limit limit) { return stages[static_cast<std::size_t>(limit)]; }
};

/// Limits by the share of right placements that they keep: below each limit of a share q lie 1 - q
/// of the placements that end right.
struct LearnedLimits {
  struct Level {
    double keep_right = 1;             ///< q, (0, 1).
    Limits with_color, without_color;  ///< For frames and models with and without colours.
  };
  std::vector<Level> levels;  ///< At least one, by rising q.
  std::string provenance;     ///< Who made them of what, for people.

  /// The limits for `keep_right`, between two levels linear in log(1 - q). With 1 nothing is given
  /// up. Fails with invalid_argument outside of the levels.
  Result<Limits> at(double keep_right, bool colored) const;
};

}  // namespace bpa
