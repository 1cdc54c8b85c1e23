// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/tracks.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

Pose random_pose() {
  return {Eigen::Quaterniond(Eigen::Vector4d::Random()).normalized(), Eigen::Vector3d::Random()};
}

Track full_track() {
  Track track;
  track.id = std::numeric_limits<std::uint64_t>::max();
  track.name = "the blue mug";
  track.model = "mug";
  track.model_number = 7;
  track.state = TrackState::occluded;
  track.probability = 1.0 / 3;
  track.frame_from_object = random_pose();
  track.covariance.setRandom();
  track.orientation.axes.setRandom();
  track.orientation.concentrations.setRandom();
  track.velocity.setRandom();
  track.angular_velocity.setRandom();
  track.visible_fraction = 0.1;
  track.age_s = 2.0 / 3;
  track.unseen_s = 0.7;
  track.held = true;
  track.weight = 0.6;
  track.alternatives = {{random_pose(), 0.3}, {random_pose(), 0.1}};
  return track;
}

TrackResult full_frame() {
  TrackResult frame;
  frame.scene_id = 3;
  frame.im_id = 14;
  frame.stamp_ns = 1'700'000'000'123'456'789;
  frame.frame_id = "map";
  frame.camera_frame_id = "camera";
  frame.in_fixed_frame = true;
  frame.frame_from_camera = random_pose();
  frame.tracks = {full_track(), Track{}};
  frame.ended = {{4, "mug_1", "not seen for 5 s"}};
  frame.milliseconds = 12.3;
  return frame;
}

void expect_same(const Pose& a, const Pose& b) {
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

void expect_same(const Track& a, const Track& b) {
  EXPECT_EQ(std::tie(a.id, a.name, a.model, a.model_number, a.state, a.probability),
            std::tie(b.id, b.name, b.model, b.model_number, b.state, b.probability));
  expect_same(a.frame_from_object, b.frame_from_object);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.orientation.axes, b.orientation.axes);
  EXPECT_EQ(a.orientation.concentrations, b.orientation.concentrations);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.angular_velocity, b.angular_velocity);
  EXPECT_EQ(std::tie(a.visible_fraction, a.age_s, a.unseen_s, a.held, a.weight),
            std::tie(b.visible_fraction, b.age_s, b.unseen_s, b.held, b.weight));
  ASSERT_EQ(a.alternatives.size(), b.alternatives.size());
  for (std::size_t i = 0; i < a.alternatives.size(); ++i) {
    expect_same(a.alternatives[i].frame_from_object, b.alternatives[i].frame_from_object);
    EXPECT_EQ(a.alternatives[i].weight, b.alternatives[i].weight);
  }
}

TEST(Tracks, JsonKeepsEverythingToTheLastBit) {
  const test::TemporaryFolder folder;
  const TrackResult written = full_frame();
  ASSERT_TRUE(write_tracks_json(folder / "t.json", {written, TrackResult{}}).ok());
  const auto back = read_tracks_json(folder / "t.json");
  ASSERT_TRUE(back.ok()) << back.status().message;
  ASSERT_EQ(back->size(), 2u);
  const TrackResult& read = back->front();
  EXPECT_EQ(std::tie(read.scene_id, read.im_id, read.stamp_ns, read.frame_id, read.camera_frame_id),
            std::tie(written.scene_id, written.im_id, written.stamp_ns, written.frame_id,
                     written.camera_frame_id));
  EXPECT_EQ(read.in_fixed_frame, true);
  EXPECT_EQ(read.milliseconds, 12.3);
  expect_same(read.frame_from_camera, written.frame_from_camera);
  ASSERT_EQ(read.tracks.size(), 2u);
  for (int i = 0; i < 2; ++i) expect_same(read.tracks[i], written.tracks[i]);
  ASSERT_EQ(read.ended.size(), 1u);
  EXPECT_EQ(read.ended[0].id, 4u);
  EXPECT_EQ(read.ended[0].name, "mug_1");
  EXPECT_EQ(read.ended[0].reason, "not seen for 5 s");
}

TEST(Tracks, ALineIsOneFrameOfTheFile) {
  const test::TemporaryFolder folder;
  const std::string line = track_json_line(full_frame());
  EXPECT_EQ(line.find('\n'), std::string::npos);
  test::spill(folder / "t.json",
              R"({"format": "bpa tracks", "version": 1, "frames": [)" + line + "]}");
  const auto back = read_tracks_json(folder / "t.json");
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(back->front().tracks.size(), 2u);
}

TEST(Tracks, EveryStateHasItsName) {
  const test::TemporaryFolder folder;
  for (const TrackState state :
       {TrackState::tentative, TrackState::confirmed, TrackState::occluded, TrackState::lost}) {
    TrackResult frame;
    frame.tracks.resize(1);
    frame.tracks.front().state = state;
    EXPECT_NE(track_json_line(frame).find('"' + std::string(name_of(state)) + '"'),
              std::string::npos);
    ASSERT_TRUE(write_tracks_json(folder / "t.json", {frame}).ok());
    EXPECT_EQ(read_tracks_json(folder / "t.json")->front().tracks.front().state, state);
  }
}

TEST(Tracks, BadFilesGiveOneErrorThatNamesThem) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "t.json";
  EXPECT_EQ(read_tracks_json(path).status().code, StatusCode::not_found);
  ASSERT_TRUE(write_tracks_json(path, {full_frame()}).ok());
  const std::string good = test::slurp(path);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = good;
    const std::size_t at = bad.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return bad.replace(at, from.size(), to);
  };
  for (const std::string& bad :
       {std::string("{}"), std::string("[]"), good.substr(0, good.size() / 2),
        with("\"bpa tracks\"", "\"bpa results\""), with("\"version\": 1", "\"version\": 99"),
        with("\"occluded\"", "\"elsewhere\""), with("\"id\"", "\"di\""),
        with("\"state\"", "\"etats\""), with("\"im_id\": 14", "\"im_id\": 1e300"),
        with("\"im_id\": 14", "\"im_id\": null"), with("\"ended\": [", "\"ended\": [7,")}) {
    test::spill(path, bad);
    const Status status = read_tracks_json(path).status();
    EXPECT_EQ(status.code, StatusCode::corrupt) << bad.substr(0, 100);
    EXPECT_NE(status.message.find(path), std::string::npos) << status.message;
  }
}

}  // namespace
}  // namespace bpa::io
