// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "core/base/log.hpp"
#include "core/result/track.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "server/convert/tracks.hpp"
#include "server/output.hpp"
#include "server/recognition.hpp"
#include "server/settings.hpp"
#include "server/sources/transform_source.hpp"

namespace bpa::server {

/// Publishes tracks, each message only while it has a subscriber.
class TrackPublisher {
 public:
  /// Opens the topics; `settings` outlives it. Throws a Failure.
  TrackPublisher(const wire::Participant& participant, const Settings& settings,
                 std::shared_ptr<const Recognition> recognition, LogHook log)
      : settings_(settings), recognition_(std::move(recognition)), log_(std::move(log)) {
    const Settings::Snapshot all = settings.get();
    const OutputOptions& options = all->output;
    const wire::Qos results = wire::qos::results();
    tracks_.open(participant, options.tracks, results);
    states_.open(participant, options.track_states, results);
    markers_.open(participant, options.track_markers, results);
    tf_.open(participant, options.tf, wire::qos::transforms(),
             own_transform_readers(participant, *all));
  }

  /// Whether any topic has a subscriber; /tf counts only if tracks are sent there.
  bool wanted() const {
    return tracks_.wanted() || states_.wanted() || markers_.wanted() || transforms_wanted();
  }

  void publish(const TrackedFrame& frame) {
    if (states_.wanted()) states_.send(track_states_message(frame), log_);
    if (transforms_wanted()) tf_.send(track_transforms_message(frame), log_);
    const Models models = tracks_.wanted() || markers_.wanted() ? recognition_->models() : Models();
    if (tracks_.wanted()) tracks_.send(tracks_message(frame, models), log_);
    if (!markers_.wanted()) return;
    const double lifetime_s = settings_.get()->output.marker_lifetime_s;
    markers_.send(track_markers_message(frame, models, lifetime_s), log_);
  }

 private:
  bool transforms_wanted() const { return settings_.get()->tracking.publish_tf && tf_.wanted(); }

  const Settings& settings_;
  const std::shared_ptr<const Recognition> recognition_;
  const LogHook log_;
  Output<wire::vision_msgs::Detection3DArray> tracks_;
  Output<wire::bpa_msgs::Tracks> states_;
  Output<wire::visualization_msgs::MarkerArray> markers_;
  Output<wire::tf2_msgs::TFMessage> tf_;
};

}  // namespace bpa::server
