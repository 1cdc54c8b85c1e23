// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/tracks.hpp"

#include <gtest/gtest.h>

#include "client/src/convert.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/some_track.hpp"

// Tracks as the core has them, as bytes on the wire, in the SDK's structs and in standard messages.

namespace bpa::server {
namespace {

Track track(std::uint64_t id, TrackState state) {
  Track track = test::some_track();
  track.id = id;
  track.name = "mug_" + std::to_string(id);
  track.state = state;
  return track;
}

TrackedFrame tracked() {
  TrackedFrame frame;
  frame.stamp_ns = 3'000'000'007;
  frame.frame_id = "map";
  frame.camera_frame_id = "camera";
  frame.in_fixed_frame = true;
  frame.frame_from_camera.translation = {7, 8, 9};
  frame.tracks = {track(1, TrackState::tentative), track(2, TrackState::confirmed),
                  track(5, TrackState::occluded), track(6, TrackState::lost)};
  frame.ended = {{4, "bowl_1", "not seen for 5 s"}};
  frame.milliseconds = 11;
  return frame;
}

Models models() {
  auto mug = std::make_shared<ObjectModel>();
  mug->name = "mug";
  mug->number = 3;
  mug->surface.points = {{0, 0, 0}, {0.1f, 0.02f, 0.04f}};
  return {mug};
}

TEST(Tracks, ReachTheSdkWithEveryField) {
  const TrackedFrame frame = tracked();
  const auto sent = track_states_message(frame);
  std::vector<std::uint8_t> bytes(wire::encoded_size(sent));
  wire::encode(sent, bytes.data(), bytes.size());
  wire::bpa_msgs::Tracks message;
  ASSERT_TRUE(wire::decode(bytes.data(), bytes.size(), message).ok());
  const TrackSet set = sdk::to_tracks(message);
  EXPECT_EQ(set.stamp_ns, frame.stamp_ns);
  EXPECT_EQ(set.frame_id, "map");
  EXPECT_EQ(set.camera_frame_id, "camera");
  EXPECT_TRUE(set.in_fixed_frame);
  EXPECT_EQ(set.frame_from_camera.position, (std::array<double, 3>{7, 8, 9}));
  EXPECT_EQ(set.total_ms, 11);
  ASSERT_EQ(set.ended.size(), 1U);
  EXPECT_EQ(set.ended[0].id, 4U);
  EXPECT_EQ(set.ended[0].name, "bowl_1");
  EXPECT_EQ(set.ended[0].reason, "not seen for 5 s");
  ASSERT_EQ(set.tracks.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(to_string(set.tracks[i].state), name_of(frame.tracks[i].state));
  }
  const TrackedObject& object = set.tracks[1];
  EXPECT_EQ(object.id, 2U);
  EXPECT_EQ(object.name, "mug_2");
  EXPECT_EQ(object.model, "mug");
  EXPECT_EQ(object.model_number, 3);
  EXPECT_EQ(object.probability, 0.9);
  EXPECT_EQ(object.frame_from_object.position, (std::array<double, 3>{0.1, -0.2, 1}));
  const Eigen::Quaterniond& q = frame.tracks[1].frame_from_object.rotation;
  EXPECT_EQ(object.frame_from_object.orientation,
            (std::array<double, 4>{q.x(), q.y(), q.z(), q.w()}));
  for (std::size_t i = 0; i < 36; ++i) EXPECT_EQ(object.covariance[i], 100 + i);
  EXPECT_EQ(object.orientation_spread.axes[0], (std::array<double, 4>{200, 203, 206, 209}));
  EXPECT_EQ(object.orientation_spread.concentrations, (std::array<double, 3>{-31, -21, -11}));
  EXPECT_EQ(object.velocity, (std::array<double, 3>{0.01, 0.02, 0.03}));
  EXPECT_EQ(object.angular_velocity, (std::array<double, 3>{0.4, 0.5, 0.6}));
  EXPECT_EQ(object.visible_fraction, 0.7);
  EXPECT_EQ(object.age_s, 8);
  EXPECT_EQ(object.unseen_s, 0.25);
  EXPECT_TRUE(object.held);
  EXPECT_EQ(object.weight, 0.6);
  ASSERT_EQ(object.alternatives.size(), 1U);
  EXPECT_EQ(object.alternatives[0].weight, 0.4);
  EXPECT_EQ(object.alternatives[0].frame_from_object.position, (std::array<double, 3>{1, 2, 3}));
}

TEST(Tracks, AreDetectionsWhereTheirPlaceIsKnown) {
  const auto message = tracks_message(tracked(), models());
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(to_ns(message.header.stamp), 3'000'000'007);
  ASSERT_EQ(message.detections.size(), 2U);
  EXPECT_EQ(message.detections[0].id, "2");
  EXPECT_EQ(message.detections[1].id, "5");
  const auto& detection = message.detections[0];
  EXPECT_EQ(detection.header.frame_id, "map");
  ASSERT_EQ(detection.results.size(), 1U);
  EXPECT_EQ(detection.results[0].hypothesis.class_id, "mug");
  EXPECT_EQ(detection.results[0].hypothesis.score, 0.9);
  EXPECT_EQ(detection.results[0].pose.covariance[7], 107);
  EXPECT_NEAR(detection.bbox.size.x, 0.1, 1e-6);
}

TEST(Tracks, AreTransformsByTheirNames) {
  const auto message = track_transforms_message(tracked());
  ASSERT_EQ(message.transforms.size(), 2U);
  EXPECT_EQ(message.transforms[0].header.frame_id, "map");
  EXPECT_EQ(message.transforms[0].child_frame_id, "mug_2");
  EXPECT_EQ(message.transforms[0].transform.translation.z, 1);
}

TEST(Tracks, HaveMarkersThatSayTheirState) {
  const auto message = track_markers_message(tracked(), models(), 2);
  ASSERT_EQ(message.markers.size(), 9U);
  EXPECT_EQ(message.markers[0].action, wire::visualization_msgs::Marker::kDeleteall);
  EXPECT_EQ(message.markers[1].ns, "boxes");
  EXPECT_EQ(message.markers[1].id, 1);
  EXPECT_EQ(message.markers[8].text, "mug_6 lost");
  EXPECT_LT(message.markers[7].color.a, message.markers[3].color.a);
  EXPECT_EQ(message.markers[3].lifetime.sec, 2);
}

TEST(Tracks, OfNoObjectAreEmptyMessages) {
  const TrackedFrame nothing;
  EXPECT_TRUE(track_states_message(nothing).tracks.empty());
  EXPECT_TRUE(tracks_message(nothing, {}).detections.empty());
  EXPECT_TRUE(track_transforms_message(nothing).transforms.empty());
  EXPECT_EQ(track_markers_message(nothing, {}, 0).markers.size(), 1U);
}

}  // namespace
}  // namespace bpa::server
