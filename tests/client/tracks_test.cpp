// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/tracks.hpp"

#include <gtest/gtest.h>

#include "client/cli/convert.hpp"
#include "client/src/convert.hpp"
#include "idl/wire/cdr.hpp"

namespace bpa::cli {
namespace {

TEST(ClientTracks, AreInFilesAsTheTrackerMadeThem) {
  Track track;
  track.id = 7;
  track.name = "mine";
  track.model = "mug";
  track.model_number = 3;
  track.state = TrackState::occluded;
  track.probability = 1.0 / 3;
  track.frame_from_object = {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.3).normalized(), {0.1, -0.2, 1}};
  for (int i = 0; i < 36; ++i) track.covariance(i / 6, i % 6) = 100 + i;
  for (int i = 0; i < 12; ++i) track.orientation.axes(i / 3, i % 3) = 200 + i;
  track.orientation.concentrations = {-31, -21, -11};
  track.velocity = {0.01, 0.02, 0.03};
  track.angular_velocity = {0.4, 0.5, 0.6};
  track.visible_fraction = 0.7;
  track.age_s = 8.5;
  track.unseen_s = 0.25;
  track.held = true;
  track.weight = 0.6;
  track.alternatives = {{{Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4).normalized(), {1, 2, 3}}, 0.4}};
  io::TrackResult made;
  made.scene_id = 48;
  made.im_id = 7;
  made.stamp_ns = 3'000'000'007;
  made.frame_id = "map";
  made.camera_frame_id = "48/7";
  made.in_fixed_frame = true;
  made.frame_from_camera = track.frame_from_object;
  made.tracks = {track};
  made.ended = {{4, "bowl_1", "not seen for 5 s"}};
  made.milliseconds = 11.25;

  const auto sent = server::track_states_message(made);
  std::vector<std::uint8_t> bytes(wire::encoded_size(sent));
  wire::encode(sent, bytes.data(), bytes.size());
  wire::bpa_msgs::Tracks message;
  ASSERT_TRUE(wire::decode(bytes.data(), bytes.size(), message).ok());
  EXPECT_EQ(io::track_json_line(to_track_result(sdk::to_tracks(message))),
            io::track_json_line(made));
}

}  // namespace
}  // namespace bpa::cli
