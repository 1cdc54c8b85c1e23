// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "core/eval/assignment.hpp"
#include "core/eval/track_evaluation.hpp"

namespace bpa::eval {
namespace {

/// In the camera's frame, without an id.
Track track_of(const Placement& placement) {
  Track track;
  track.model = placement.model;
  track.model_number = placement.model_number;
  track.state = TrackState::confirmed;
  track.probability = placement.probability;
  track.frame_from_object = placement.frame_from_object;
  track.covariance = placement.covariance;
  track.orientation = placement.orientation;
  track.visible_fraction = placement.visible_fraction;
  return track;
}

}  // namespace

std::vector<io::TrackResult> linked_detections(const std::vector<io::FrameResult>& results,
                                               double reach_m) {
  constexpr double kMillisecondsPerSecond = 1000;
  std::map<std::pair<int, int>, const io::FrameResult*> ordered;
  for (const io::FrameResult& result : results) ordered[{result.scene_id, result.im_id}] = &result;
  std::vector<io::TrackResult> linked;
  std::uint64_t last_id = 0;
  for (const auto& [key, result] : ordered) {
    const bool begins = linked.empty() || linked.back().scene_id != key.first;
    const std::vector<Track> before = begins ? std::vector<Track>() : linked.back().tracks;
    io::TrackResult& frame = linked.emplace_back();
    frame.scene_id = key.first;
    frame.im_id = key.second;
    frame.stamp_ns = result->stamp_ns;
    frame.milliseconds = kMillisecondsPerSecond * result->seconds;
    if (result->interpretations.empty()) continue;
    std::vector<std::vector<double>> costs;
    for (const Placement& placement : result->interpretations.front().placements) {
      frame.tracks.push_back(track_of(placement));
      std::vector<double>& row = costs.emplace_back(before.size(), kNoMatch);
      for (std::size_t k = 0; k < before.size(); ++k) {
        const double distance =
            (before[k].frame_from_object.translation - placement.frame_from_object.translation)
                .norm();
        if (before[k].model_number == placement.model_number && distance <= reach_m) {
          row[k] = distance;
        }
      }
    }
    const std::vector<int> link = assigned(costs);
    for (std::size_t i = 0; i < frame.tracks.size(); ++i) {
      frame.tracks[i].id = link[i] >= 0 ? before[link[i]].id : ++last_id;
    }
  }
  return linked;
}

}  // namespace bpa::eval
