// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/private/track_counter.hpp"

#include <algorithm>
#include <cmath>

#include "core/eval/assignment.hpp"

namespace bpa::eval {
namespace {

constexpr double kAddsLimit = 0.1;   // of the area under the curve, metres; YCB-Video
constexpr double kAddsClose = 0.02;  // metres; Wang et al. 2019, DenseFusion

/// The costs of those estimates and instances that are free.
std::vector<std::vector<double>> free_costs(const TrackFrame& frame,
                                            const std::vector<int>& truth_of_estimate,
                                            const std::vector<bool>& offered) {
  std::vector<std::vector<double>> costs(frame.estimates.size(),
                                         std::vector<double>(frame.truth.size(), kNoMatch));
  std::vector<bool> taken(frame.truth.size(), false);
  for (const int truth : truth_of_estimate) {
    if (truth >= 0) taken[truth] = true;
  }
  for (std::size_t e = 0; e < frame.estimates.size(); ++e) {
    if (truth_of_estimate[e] >= 0) continue;
    for (std::size_t t = 0; t < frame.truth.size(); ++t) {
      if (offered[t] && !taken[t]) costs[e][t] = frame.pairs[e][t].distance;
    }
  }
  return costs;
}

/// The instance of each estimate, -1 for none. `track_of` has the last match of each identity.
std::vector<int> match_frame(const TrackFrame& frame, const std::vector<bool>& counts,
                             const std::map<int, std::uint64_t>& track_of) {
  std::vector<int> truth_of_estimate(frame.estimates.size(), -1);
  for (std::size_t t = 0; t < frame.truth.size(); ++t) {
    const auto last = track_of.find(frame.truth[t].identity);
    if (!counts[t] || last == track_of.end()) continue;
    const auto at = std::ranges::find(frame.estimates, last->second);
    if (at == frame.estimates.end()) continue;
    const auto e = static_cast<std::size_t>(at - frame.estimates.begin());
    if (frame.pairs[e][t].distance < kNoMatch) truth_of_estimate[e] = static_cast<int>(t);
  }
  // First what counts, then the rest, which makes the others neither right nor false.
  for (const bool counting : {true, false}) {
    std::vector<bool> offered = counts;
    if (!counting) offered.flip();
    const std::vector<int> more = assigned(free_costs(frame, truth_of_estimate, offered));
    for (std::size_t e = 0; e < more.size(); ++e) {
      if (more[e] >= 0) truth_of_estimate[e] = more[e];
    }
  }
  return truth_of_estimate;
}

}  // namespace

std::vector<int> TrackCounter::add(const TrackFrame& frame) {
  std::vector<bool> counting;
  for (const TrackedTruth& truth : frame.truth) {
    counting.push_back(truth.visibility == Visibility::visible ||
                       (with_hidden_ && truth.visibility == Visibility::hidden));
    if (!counting.back()) continue;
    ++counts_.instances;
    identities_.insert(truth.identity);
  }
  std::vector<int> matches = match_frame(frame, counting, track_of_);
  for (std::size_t e = 0; e < matches.size(); ++e) {
    if (matches[e] < 0) ++counts_.false_reports;
    if (matches[e] >= 0 && !counting[matches[e]]) {
      matches[e] = -1;
      continue;
    }
    if (matches[e] >= 0) add_match(frame, e, matches[e]);
    for (std::size_t t = 0; t < frame.truth.size(); ++t) {
      if (!counting[t] || frame.pairs[e][t].distance == kNoMatch) continue;
      ++together_[{frame.truth[t].identity, frame.estimates[e]}];
    }
  }
  return matches;
}

TrackCounts TrackCounter::finished() {
  counts_.objects = static_cast<int>(identities_.size());
  counts_.identity_matched = most_in_common();
  return counts_;
}

void TrackCounter::add_match(const TrackFrame& frame, std::size_t estimate, int truth) {
  const NearPair& pair = frame.pairs[estimate][truth];
  ++counts_.matched;
  counts_.distance_sum += pair.distance;
  counts_.adds_area_sum += std::max(0.0, 1 - pair.adds / kAddsLimit);
  counts_.within_2cm += pair.adds < kAddsClose;
  counts_.right += pair.right;
  const auto [last, first] =
      track_of_.try_emplace(frame.truth[truth].identity, frame.estimates[estimate]);
  counts_.switches += !first && last->second != frame.estimates[estimate];
  last->second = frame.estimates[estimate];
}

/// Frames in which objects and tracks are together, when each object has one track at most and
/// each track one object.
int TrackCounter::most_in_common() const {
  std::map<std::uint64_t, std::size_t> columns;
  for (const auto& [pair, frames] : together_) columns.try_emplace(pair.second, columns.size());
  std::vector<std::vector<double>> costs;
  for (const int identity : identities_) {
    std::vector<double>& row = costs.emplace_back(columns.size(), 0.0);
    for (const auto& [track, column] : columns) {
      const auto found = together_.find({identity, track});
      if (found != together_.end()) row[column] = -found->second;
    }
  }
  const std::vector<int> column_of = assigned(costs);
  double frames = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (column_of[i] >= 0) frames -= costs[i][column_of[i]];
  }
  return static_cast<int>(std::lround(frames));
}

}  // namespace bpa::eval
