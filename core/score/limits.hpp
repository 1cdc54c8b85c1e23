// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.hpp"
#include "core/score/components.hpp"

// Log odds below which a candidate is given up. They are of the score layers that make the log
// odds, and lie in one file with them. `bpa train` measures them with these layers.

namespace bpa::score {

/// Where the search compares a candidate's log odds with a limit.
enum class Limit : std::uint8_t {
  ranked,     ///< A pose from features or pairs goes on to clustering.
  clustered,  ///< A cluster goes on to round two.
  aligned,    ///< A pose is aligned to the end.
  refined,    ///< An aligned pose is scored with all components.
  repeated,   ///< A pose that an earlier round scored may be scored again.
  climbed,    ///< A placement climbs the score.
  turned,     ///< A placement is tried in near-symmetric poses.
  laid,       ///< A pose at rest on a flat region is moved and scored in full.
  compared,   ///< The best placement of a place is compared with its rivals.
  selected,   ///< A placement is returned.
  competing,  ///< A placement competes for its pixels with others.
  // Log odds less those of the best candidate in its place, of any model.
  checked_behind,    ///< A checked pose goes on to clustering.
  clustered_behind,  ///< A cluster goes on to round two.
  aligned_behind,    ///< A pose of round two is aligned to the end.
  refined_behind,    ///< An aligned pose is scored with all components.
  rival_behind,      ///< A placement is compared with the best as its rival.
  contender_behind   ///< A rival makes the others less probable.
};
inline constexpr std::string_view kLimitNames[] = {
    "ranked",           "clustered",      "aligned",        "refined",
    "repeated",         "climbed",        "turned",         "laid",
    "compared",         "selected",       "competing",      "checked_behind",
    "clustered_behind", "aligned_behind", "refined_behind", "rival_behind",
    "contender_behind"};
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

/// Least log odds that a placement, and the candidates that it comes from, had where a limit is.
/// Plus infinity where there was none.
struct LowestLogOdds {
  std::array<float, kLimits> stages;

  LowestLogOdds() { stages.fill(std::numeric_limits<float>::infinity()); }
  void note(Limit limit, double log_odds) {
    float& lowest = stages[static_cast<std::size_t>(limit)];
    lowest = std::min(lowest, static_cast<float>(log_odds));
  }
};

/// What measure_limits() reads of a placement that ended right.
struct RightPlacement {
  LowestLogOdds lowest;
  std::array<float, kScoreComponents.size()> components{};  ///< As Limits::components.
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

/// The limits for 0.9 and 0.9999, of searches without limits, with and without colours. The tenth
/// of the placements with the lowest log odds are taken as exponential (peaks over a threshold:
/// Coles, An Introduction to Statistical Modeling of Extreme Values, 2001, chapter 4, with shape
/// 0). A limit with fewer than 50 placements, and one that `start` does not have, is that of
/// `start` at its highest level.
LearnedLimits measure_limits(const std::vector<RightPlacement>& with_color,
                             const std::vector<RightPlacement>& without_color,
                             const LearnedLimits& start);

}  // namespace bpa::score
