// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result/track.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/tf2_msgs.hpp"
#include "idl/wire/msg/vision_msgs.hpp"
#include "idl/wire/msg/visualization_msgs.hpp"
#include "server/convert/results.hpp"

// Tracks -> messages. Stamp and frame_id are those of the frame.

namespace bpa::server {

/// Whether where the object is is known: the track is confirmed or occluded.
bool has_place(const Track& track);

/// All tracks, and those that ended.
wire::bpa_msgs::Tracks track_states_message(const TrackedFrame& frame);

/// Those that have a place: class_id is the model's name, score the probability, bbox the box along
/// the model's axes, id the track's in decimal digits.
wire::vision_msgs::Detection3DArray tracks_message(const TrackedFrame& frame, const Models& models);

/// A box and "NAME STATE" per track, after a marker that deletes the last frame's. Those without a
/// place are more transparent.
wire::visualization_msgs::MarkerArray track_markers_message(const TrackedFrame& frame,
                                                            const Models& models,
                                                            double lifetime_s);

/// A transform per track that has a place; the child frame is its name.
wire::tf2_msgs::TFMessage track_transforms_message(const TrackedFrame& frame);

}  // namespace bpa::server
