// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/tracks.hpp"

#include <gtest/gtest.h>

#include "client/cli/convert.hpp"
#include "client/src/convert.hpp"
#include "idl/wire/cdr.hpp"
#include "tests/support/some_track.hpp"

namespace bpa::cli {
namespace {

TEST(ClientTracks, AreInFilesAsTheTrackerMadeThem) {
  Track track = test::some_track();
  track.name = "mine";
  track.probability = 1.0 / 3;
  track.age_s = 8.5;
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
