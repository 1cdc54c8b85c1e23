// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/model/library.hpp"
#include "core/model/object_model.hpp"
#include "core/result/interpretation.hpp"
#include "core/result/placement.hpp"
#include "core/track/follow.hpp"

namespace bpa::track {

/// Where a track was in one frame.
struct TrackRecord {
  std::uint64_t id = 0;
  std::shared_ptr<const ObjectModel> model;
  Pose camera_from_object;
  Sight sight = Sight::seen;
  double visible_fraction = 0;
  double unseen_s = 0;
};

/// What a search has found: placements of objects that are there with at least `min_presence`, at
/// this pose or an alternative. The best interpretation comes first. Others add what is in a place
/// of its own.
std::vector<Placement> found_objects(const SceneInterpretations& result,
                                     const ModelLibrary& library, double min_presence);

/// For each placement of a frame, the index of the track that it shows; -1: none. A track is given
/// to one placement, of its model, near to where it was: the nearest pairs first. The longer it was
/// not seen, the further it may have gone.
std::vector<int> match_tracks(const std::vector<Placement>& placements,
                              const std::vector<TrackRecord>& tracks);

/// Whether two poses of a model claim one place.
bool in_one_place(const ObjectModel& model, const Pose& a, const Pose& b);

/// Whether a placement of another model claims the place of the track.
bool claims_place(const Placement& placement, const TrackRecord& track);

}  // namespace bpa::track
