// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result/track.hpp"

namespace bpa::test {

/// A track in which every number differs from every other, so that none can stand for another.
inline Track some_track() {
  Track track;
  track.id = 7;
  track.name = "mug_7";
  track.model = "mug";
  track.model_number = 3;
  track.state = TrackState::occluded;
  track.probability = 0.9;
  track.frame_from_object = {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.3).normalized(), {0.1, -0.2, 1}};
  for (int i = 0; i < 36; ++i) track.covariance(i / 6, i % 6) = 100 + i;
  for (int i = 0; i < 12; ++i) track.orientation.axes(i / 3, i % 3) = 200 + i;
  track.orientation.concentrations = {-31, -21, -11};
  track.velocity = {0.01, 0.02, 0.03};
  track.angular_velocity = {0.4, 0.5, 0.6};
  track.visible_fraction = 0.7;
  track.age_s = 8;
  track.unseen_s = 0.25;
  track.held = true;
  track.weight = 0.6;
  track.alternatives = {{{Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4).normalized(), {1, 2, 3}}, 0.4}};
  return track;
}

}  // namespace bpa::test
