// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/tracks.hpp"

#include "core/io/private/result_json.hpp"

/// A state by its name; another name is an error.
template <>
struct nlohmann::adl_serializer<bpa::TrackState> {
  static void to_json(json& out, bpa::TrackState state) { out = bpa::name_of(state); }
  static void from_json(const json& in, bpa::TrackState& state) {
    for (int k = 0; k <= static_cast<int>(bpa::TrackState::lost); ++k) {
      state = static_cast<bpa::TrackState>(k);
      if (in == bpa::name_of(state)) return;
    }
    throw std::out_of_range(in.dump() + " is not the state of a track");
  }
};

namespace bpa {

using io::kOptional;

static void fields(auto& visit, io::Is<Track> auto& track) {
  visit("id", track.id);
  visit("name", track.name, kOptional);
  visit("obj_id", track.model_number);
  visit("model", track.model, kOptional);
  visit("state", track.state);
  visit("probability", track.probability);
  visit("pose", track.frame_from_object);
  visit("covariance", track.covariance, kOptional);
  visit("bingham", track.orientation, kOptional);
  visit("velocity", track.velocity, kOptional);
  visit("angular_velocity", track.angular_velocity, kOptional);
  visit("visible_fraction", track.visible_fraction, kOptional);
  visit("age_s", track.age_s, kOptional);
  visit("unseen_s", track.unseen_s, kOptional);
  visit("held", track.held, kOptional);
  visit("weight", track.weight, kOptional);
  visit("alternatives", track.alternatives, kOptional);
}

static void fields(auto& visit, io::Is<EndedTrack> auto& track) {
  visit("id", track.id);
  visit("name", track.name, kOptional);
  visit("reason", track.reason, kOptional);
}

namespace io {

constexpr FramesFormat kTracksFormat{"bpa tracks", "a file of tracks", 1};

static void fields(auto& visit, Is<TrackResult> auto& frame) {
  visit("scene_id", frame.scene_id);
  visit("im_id", frame.im_id);
  visit("stamp_ns", frame.stamp_ns);
  visit("frame_id", frame.frame_id, kOptional);
  visit("camera_frame_id", frame.camera_frame_id, kOptional);
  visit("in_fixed_frame", frame.in_fixed_frame, kOptional);
  visit("frame_from_camera", frame.frame_from_camera, kOptional);
  visit("milliseconds", frame.milliseconds, kOptional);
  visit("tracks", frame.tracks);
  visit("ended", frame.ended, kOptional);
}

std::string track_json_line(const TrackResult& frame) { return json_line(frame); }

Status write_tracks_json(const std::string& path, const std::vector<TrackResult>& frames) {
  return write_frames_json(path, kTracksFormat, frames);
}

Result<std::vector<TrackResult>> read_tracks_json(const std::string& path) {
  return read_frames_json<TrackResult>(path, kTracksFormat);
}

}  // namespace io
}  // namespace bpa
