// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/association.hpp"

#include <algorithm>

#include "core/detect/candidate.hpp"

namespace bpa::track {
namespace {

// Chosen by hand.
constexpr double kLeastGate_m = 0.03;
constexpr double kSpeed = 0.5;  // m/s: of what is not seen
constexpr double kMostGate_m = 0.6;

double gate(const TrackRecord& track) {
  const double here = std::max(kLeastGate_m, kSamePlace * track.model->diameter);
  return track.sight == Sight::seen
             ? here
             : std::min(std::max(here, kMostGate_m), here + kSpeed * track.unseen_s);
}

Eigen::Vector3d place(const TrackRecord& track) {
  return track.camera_from_object * track.model->centre;
}

}  // namespace

std::vector<int> match_tracks(const std::vector<Placement>& placements,
                              const std::vector<TrackRecord>& tracks) {
  struct Pair {
    double distance;
    int placement, track;
  };
  std::vector<Pair> pairs;
  for (int p = 0; p < std::ssize(placements); ++p) {
    for (int t = 0; t < std::ssize(tracks); ++t) {
      const TrackRecord& track = tracks[t];
      if (placements[p].model != track.model->name) continue;
      const Eigen::Vector3d there = placements[p].camera_from_object * track.model->centre;
      const double distance = (there - place(track)).norm();
      if (distance < gate(track)) pairs.push_back({distance, p, t});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::distance);
  std::vector<int> matched(placements.size(), -1);
  std::vector<bool> taken(tracks.size(), false);
  for (const Pair& pair : pairs) {
    if (matched[pair.placement] >= 0 || taken[pair.track]) continue;
    matched[pair.placement] = pair.track;
    taken[pair.track] = true;
  }
  return matched;
}

bool in_one_place(const ObjectModel& model, const Pose& a, const Pose& b) {
  return (a * model.centre - b * model.centre).norm() < kSamePlace * model.diameter;
}

bool claims_place(const Placement& placement, const TrackRecord& track) {
  if (placement.model == track.model->name) return false;
  const double distance = (placement.camera_from_object.translation - place(track)).norm();
  return distance < kSamePlace * track.model->diameter;
}

}  // namespace bpa::track
