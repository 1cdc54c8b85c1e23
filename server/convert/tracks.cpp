// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/tracks.hpp"

#include <utility>

#include "server/convert/parts.hpp"

namespace bpa::server {
namespace {

using wire::geometry_msgs::Vector3;

wire::std_msgs::Header header_of_tracks(const TrackedFrame& frame) {
  return header_message(frame.stamp_ns, frame.frame_id);
}

wire::bpa_msgs::Track track_message(const Track& track) {
  wire::bpa_msgs::Track message{
      .id = track.id,
      .name = track.name,
      .model = track.model,
      .model_number = static_cast<std::uint32_t>(track.model_number),
      .state = static_cast<std::uint8_t>(track.state),
      .probability = track.probability,
      .pose = pose_message(track.frame_from_object, track.covariance),
      .orientation = bingham_message(track.orientation),
      .velocity = {xyz<Vector3>(track.velocity), xyz<Vector3>(track.angular_velocity)},
      .visible_fraction = track.visible_fraction,
      .age_s = track.age_s,
      .unseen_s = track.unseen_s,
      .held = track.held,
      .weight = track.weight,
      .alternatives = {}};
  for (const PoseAlternative& other : track.alternatives) {
    message.alternatives.push_back({pose_message(other.frame_from_object), other.weight});
  }
  return message;
}

}  // namespace

// The constants of bpa_msgs/Track are the numbers of the states.
static_assert(wire::bpa_msgs::Track::kTentative == static_cast<int>(TrackState::tentative));
static_assert(wire::bpa_msgs::Track::kConfirmed == static_cast<int>(TrackState::confirmed));
static_assert(wire::bpa_msgs::Track::kOccluded == static_cast<int>(TrackState::occluded));
static_assert(wire::bpa_msgs::Track::kLost == static_cast<int>(TrackState::lost));

bool has_place(const Track& track) {
  return track.state == TrackState::confirmed || track.state == TrackState::occluded;
}

wire::bpa_msgs::Tracks track_states_message(const TrackedFrame& frame) {
  wire::bpa_msgs::Tracks message;
  message.header = header_of_tracks(frame);
  message.camera_frame_id = frame.camera_frame_id;
  message.in_fixed_frame = frame.in_fixed_frame;
  message.camera = pose_message(frame.frame_from_camera);
  for (const Track& track : frame.tracks) message.tracks.push_back(track_message(track));
  for (const EndedTrack& ended : frame.ended) {
    message.ended.push_back({ended.id, ended.name, ended.reason});
  }
  message.total_ms = frame.milliseconds;
  return message;
}

wire::vision_msgs::Detection3DArray tracks_message(const TrackedFrame& frame,
                                                   const Models& models) {
  wire::vision_msgs::Detection3DArray message;
  message.header = header_of_tracks(frame);
  for (const Track& track : frame.tracks) {
    if (!has_place(track)) continue;
    message.detections.push_back({message.header,
                                  {{{track.model, track.probability},
                                    pose_message(track.frame_from_object, track.covariance)}},
                                  box_message(track.frame_from_object, track.model_number, models),
                                  std::to_string(track.id)});
  }
  return message;
}

wire::visualization_msgs::MarkerArray track_markers_message(const TrackedFrame& frame,
                                                            const Models& models,
                                                            double lifetime_s) {
  wire::visualization_msgs::MarkerArray message;
  const wire::std_msgs::Header header = header_of_tracks(frame);
  message.markers.push_back(clearing_marker(header));
  for (const Track& track : frame.tracks) {
    add_markers(header,
                {.id = static_cast<std::int32_t>(track.id & 0x7fffffff),
                 .box = box_message(track.frame_from_object, track.model_number, models),
                 .model_number = track.model_number,
                 .text = track.name + ' ' + std::string(name_of(track.state)),
                 .alpha = has_place(track) ? 0.5f : 0.2f},
                lifetime_s, message);
  }
  return message;
}

wire::tf2_msgs::TFMessage track_transforms_message(const TrackedFrame& frame) {
  wire::tf2_msgs::TFMessage message;
  for (const Track& track : frame.tracks) {
    if (!has_place(track)) continue;
    message.transforms.push_back(
        {header_of_tracks(frame), track.name, transform_message(track.frame_from_object)});
  }
  return message;
}

}  // namespace bpa::server
