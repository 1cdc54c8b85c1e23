// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace bpa {

/// The work of one search, as counts of one frame and all models. The same for any number of
/// threads, unless a time budget ends the search.
struct SearchEffort {
  std::int64_t rounds = 0;         ///< Samples of the scene that were searched.
  std::int64_t sampled_poses = 0;  ///< Poses from features, point pairs and priors.
  std::int64_t pose_checks = 0;    ///< Comparisons of a pose with the depth image.
  std::int64_t alignments = 0;     ///< By Gauss-Newton steps or by BPA; not the draws of a sample.
  std::int64_t quick_scores = 0;   ///< Scores with the components of round two.
  std::int64_t full_scores = 0;    ///< Scores with all components.

  bool operator==(const SearchEffort&) const = default;
};

/// One count, with the name that files give it.
struct EffortCount {
  const char* name;
  std::int64_t SearchEffort::*count;
};

/// All counts.
constexpr EffortCount kEffortCounts[] = {{"rounds", &SearchEffort::rounds},
                                         {"sampled_poses", &SearchEffort::sampled_poses},
                                         {"pose_checks", &SearchEffort::pose_checks},
                                         {"alignments", &SearchEffort::alignments},
                                         {"quick_scores", &SearchEffort::quick_scores},
                                         {"full_scores", &SearchEffort::full_scores}};

inline SearchEffort& operator+=(SearchEffort& sum, const SearchEffort& more) {
  for (const auto& [name, count] : kEffortCounts) sum.*count += more.*count;
  return sum;
}

}  // namespace bpa
