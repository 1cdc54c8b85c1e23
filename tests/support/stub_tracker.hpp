// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "server/object_tracker.hpp"

namespace bpa::support {

/// A tracker that looks at no pixel: objects stay where the last search found them. One track for
/// each placement of a model, confirmed at once.
class StubTracker : public server::ObjectTracker {
 public:
  double changed = 1;  ///< What changed_since() says of a frame that was followed.

  Result<TrackedFrame> track(std::shared_ptr<const Frame> frame,
                             const std::optional<track::CameraPose>& camera) override {
    if (frame->stamp_ns <= last_.stamp_ns) return invalid_argument("stamps must rise");
    const std::string& id = camera ? camera->frame_id : frame->frame_id;
    TrackedFrame tracked;
    tracked.stamp_ns = frame->stamp_ns;
    tracked.frame_id = id;
    tracked.camera_frame_id = frame->frame_id;
    tracked.in_fixed_frame = camera.has_value();
    if (camera) tracked.frame_from_camera = camera->fixed_from_camera;
    cameras_[frame->stamp_ns] = tracked.frame_from_camera;
    tracked.tracks = last_.tracks;
    tracked.ended = std::exchange(ended_, {});
    const double seconds =
        last_.stamp_ns == 0 ? 0 : 1e-9 * static_cast<double>(frame->stamp_ns - last_.stamp_ns);
    for (Track& track : tracked.tracks) track.age_s += seconds;
    for (const SceneInterpretations& found : std::exchange(found_, {})) take(found, tracked);
    ++counts_.frames;
    last_ = tracked;
    return tracked;
  }
  void begin_anew() override {
    for (const Track& track : last_.tracks) ended_.push_back({track.id, track.name, "began anew"});
    last_ = {};
    cameras_.clear();
    found_.clear();
  }
  Status add(const SceneInterpretations& found) override {
    if (cameras_.count(found.stamp_ns) == 0) return not_found("no such frame was followed");
    ++counts_.searches;
    found_.push_back(found);
    return {};
  }
  double changed_since(std::int64_t stamp_ns) const override {
    return cameras_.count(stamp_ns) > 0 ? changed : 1;
  }
  std::vector<ExpectedPlacement> expected() const override {
    std::vector<ExpectedPlacement> expected;
    for (const Track& track : last_.tracks) {
      expected.push_back(
          {track.model, last_.frame_from_camera.inverse() * track.frame_from_object});
    }
    return expected;
  }
  Status rename(std::uint64_t id, const std::string& name) override {
    return edit(id, [&](auto track) { track->name = name; });
  }
  Status hold(std::uint64_t id, bool held) override {
    return edit(id, [&](auto track) { track->held = held; });
  }
  Status forget(std::uint64_t id) override {
    return edit(id, [&](auto track) {
      ended_.push_back({track->id, track->name, "forgotten by request"});
      last_.tracks.erase(track);
      ++counts_.ends;
    });
  }
  void set_options(const track::TrackerOptions& options) override { options_ = options; }
  track::TrackerCounts counts() const override { return counts_; }

 private:
  Status edit(std::uint64_t id, const auto& change) {
    const auto track = std::ranges::find(last_.tracks, id, &Track::id);
    if (track == last_.tracks.end()) return not_found("no track has the id ", id);
    change(track);
    return {};
  }

  void take(const SceneInterpretations& found, TrackedFrame& tracked) {
    if (found.interpretations.empty()) return;
    std::map<std::string, int> seen;
    for (const Placement& placement : found.interpretations.front().placements) {
      const Pose pose = cameras_.at(found.stamp_ns) * placement.frame_from_object;
      int nth = seen[placement.model]++;
      const auto known = std::ranges::find_if(tracked.tracks, [&](const Track& track) {
        return track.model == placement.model && nth-- == 0;
      });
      if (known != tracked.tracks.end()) {
        known->frame_from_object = pose;
        continue;
      }
      Track track;
      track.id = ++last_id_;
      track.name = concat(placement.model, "_", ++born_[placement.model]);
      track.model = placement.model;
      track.model_number = placement.model_number;
      track.state = TrackState::confirmed;
      track.probability = placement.probability;
      track.frame_from_object = pose;
      track.covariance.diagonal().setConstant(1e-4);
      tracked.tracks.push_back(std::move(track));
      ++counts_.births;
      ++counts_.confirmed;
    }
  }

  track::TrackerOptions options_;
  track::TrackerCounts counts_;
  TrackedFrame last_;
  std::map<std::int64_t, Pose> cameras_;  ///< By stamp.
  std::map<std::string, int> born_;
  std::vector<SceneInterpretations> found_;
  std::vector<EndedTrack> ended_;
  std::uint64_t last_id_ = 0;
};

}  // namespace bpa::support
