// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/eval/track_evaluation.hpp"

// The frames of a sequence, with what is near what, and their sums.

namespace bpa::eval {

/// Whether an instance counts.
enum class Visibility { visible, hidden, ignored };

/// An instance in one frame.
struct TrackedTruth {
  int object = 0;  // obj_id
  int identity = 0;
  Pose camera_from_object;
  Visibility visibility = Visibility::visible;
};

/// A pair within match_m.
struct NearPair {
  double distance = kNoMatch;
  double adds = kNoMatch;  // metres
  bool right = false;
  std::optional<CovarianceError> covariance_error;  // of a confirmed track
};

/// One frame: what is there, what is said, and which of it is near.
struct TrackFrame {
  std::vector<TrackedTruth> truth;
  std::vector<std::uint64_t> estimates;      // ids
  std::vector<std::vector<NearPair>> pairs;  // [estimate][truth]
};

/// The frames of one sequence in one of the two ways of counting.
class TrackCounter {
 public:
  explicit TrackCounter(bool with_hidden) : with_hidden_(with_hidden) {}

  /// Returns the instance that counts of each estimate, -1 for none.
  std::vector<int> add(const TrackFrame& frame);
  TrackCounts finished();

 private:
  void add_match(const TrackFrame& frame, std::size_t estimate, int truth);
  int most_in_common() const;

  bool with_hidden_;
  TrackCounts counts_;
  std::set<int> identities_;
  std::map<int, std::uint64_t> track_of_;                  // the last match of each identity
  std::map<std::pair<int, std::uint64_t>, int> together_;  // frames of an identity and a track
};

}  // namespace bpa::eval
