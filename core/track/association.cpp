// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/association.hpp"

#include <algorithm>

#include "core/geometry/tolerance.hpp"

namespace bpa::track {
namespace {

// Chosen by hand.
constexpr double kSpeed = 0.5;  // m/s: of what is not seen
constexpr double kMostGate_m = 0.6;

// Many improbable poses do not add up to an object: of those with a presence above 0.5, 89/140 were
// right below this probability of the likeliest pose, 44/57 up to 0.6 (six simulated sequences).
constexpr double kLeastOfPose = 0.2;

double gate(const TrackRecord& track) {
  const double here =
      std::max(tolerance::kSamePlaceLeast_m, tolerance::kSamePlace * track.model->diameter);
  return track.sight == Sight::seen
             ? here
             : std::min(std::max(here, kMostGate_m), here + kSpeed * track.unseen_s);
}

Eigen::Vector3d place(const TrackRecord& track) {
  return track.camera_from_object * track.model->centre;
}

// Where an object is, and how near another one cannot be.
struct Place {
  Eigen::Vector3d at;
  double reach;
};

}  // namespace

std::vector<Placement> found_objects(const SceneInterpretations& result,
                                     const ModelLibrary& library, double min_presence) {
  std::vector<Placement> out;
  std::vector<Place> taken;
  for (const Interpretation& interpretation : result.interpretations) {
    for (const Placement& placement : interpretation.placements) {
      const auto model = library.find(placement.model);
      const bool likely =
          placement.probability >= kLeastOfPose && placement.presence >= min_presence;
      if (!model || !likely) continue;
      const Place place{placement.frame_from_object * model->centre,
                        tolerance::kSamePlace * model->diameter};
      const bool free = std::ranges::none_of(taken, [&place](const Place& other) {
        return (place.at - other.at).norm() < std::min(place.reach, other.reach);
      });
      if (!free) continue;
      taken.push_back(place);
      out.push_back(placement);
    }
  }
  return out;
}

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
      const Eigen::Vector3d there = placements[p].frame_from_object * track.model->centre;
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
  return (a * model.centre - b * model.centre).norm() < tolerance::kSamePlace * model.diameter;
}

bool claims_place(const Placement& placement, const TrackRecord& track) {
  if (placement.model == track.model->name) return false;
  const double distance = (placement.frame_from_object.translation - place(track)).norm();
  return distance < tolerance::kSamePlace * track.model->diameter;
}

}  // namespace bpa::track
