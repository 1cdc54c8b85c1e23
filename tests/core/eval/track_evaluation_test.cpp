// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Sequences of a few frames whose every figure is worked out by hand.
#include "core/eval/track_evaluation.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace bpa::eval {
namespace {

constexpr std::int64_t kFrameTime = 100'000'000;  // ns: ten frames per second

Pose shifted(double x, double y = 0) { return {Eigen::Quaterniond::Identity(), {x, y, 1}}; }

/// Four points at the corners of a square of 10 cm; object 2 may turn by half a turn about z.
EvalObjects square_objects() {
  EvalObject square;
  square.name = "square";
  square.diameter = 0.1 * std::sqrt(2.0);
  square.mesh.vertices = {
      {0.05f, 0.05f, 0}, {-0.05f, 0.05f, 0}, {0.05f, -0.05f, 0}, {-0.05f, -0.05f, 0}};
  EvalObjects result;
  result[1] = square;
  result[2] = square;
  result[2].symmetry.discrete = {
      {rotation_from_vector({0, 0, std::numbers::pi}), Eigen::Vector3d::Zero()}};
  result[3] = square;
  result[3].symmetry.continuous = {{}};
  return result;
}

io::BopInstance instance(int identity, const Pose& pose, double visible = 1, int obj_id = 1) {
  io::BopInstance result;
  result.obj_id = obj_id;
  result.instance = identity;
  result.camera_from_object = pose;
  result.visible_fraction = visible;
  return result;
}

io::BopFrame truth_frame(int im_id, std::vector<io::BopInstance> truth, int scene_id = 1) {
  io::BopFrame frame;
  frame.scene_id = scene_id;
  frame.im_id = im_id;
  frame.stamp_ns = 1 + im_id * kFrameTime;
  frame.has_truth = true;
  frame.truth = std::move(truth);
  return frame;
}

Track track_at(std::uint64_t id, const Pose& pose, TrackState state = TrackState::confirmed,
               int obj_id = 1) {
  Track track;
  track.id = id;
  track.model_number = obj_id;
  track.state = state;
  track.frame_from_object = pose;
  track.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
  return track;
}

io::TrackResult tracked(int im_id, std::vector<Track> tracks, double milliseconds = 1,
                        int scene_id = 1) {
  io::TrackResult result;
  result.scene_id = scene_id;
  result.im_id = im_id;
  result.tracks = std::move(tracks);
  result.milliseconds = milliseconds;
  return result;
}

TrackReport report_of(const std::vector<io::BopFrame>& frames,
                      const std::vector<io::TrackResult>& results,
                      TrackEvaluationOptions options = {}) {
  Result<TrackReport> report = evaluate_tracks(frames, square_objects(), results, options);
  EXPECT_TRUE(report.ok()) << report.status().message;
  return report.ok() ? std::move(*report) : TrackReport();
}

// Two objects, five frames. Track 1 follows object 1, but in frame 3 track 3 takes over; object 2
// is missed in frame 0 and has track 2 after that; frame 4 has one false track.
TEST(Tracks, ClearMotAndIdf1ByHand) {
  const Pose a = shifted(0), b = shifted(0.5);
  std::vector<io::BopFrame> frames;
  for (int i = 0; i < 5; ++i) frames.push_back(truth_frame(i, {instance(1, a), instance(2, b)}));
  const Pose a_near = shifted(0.01), b_near = shifted(0.5, 0.03);
  const std::vector<io::TrackResult> results = {
      tracked(0, {track_at(1, a_near)}, 5),
      tracked(1, {track_at(1, a_near), track_at(2, b_near)}, 4),
      tracked(2, {track_at(1, a_near), track_at(2, b_near)}, 3),
      tracked(3, {track_at(3, a_near), track_at(2, b_near)}, 2),
      tracked(4, {track_at(3, a_near), track_at(2, b_near), track_at(9, shifted(2))}, 1)};
  const TrackReport report = report_of(frames, results);
  const TrackCounts& counts = report.total.visible;
  EXPECT_EQ(counts.instances, 10);
  EXPECT_EQ(counts.objects, 2);
  EXPECT_EQ(counts.matched, 9);
  EXPECT_EQ(counts.false_reports, 1);
  EXPECT_EQ(counts.switches, 1);
  EXPECT_DOUBLE_EQ(counts.mota(), 1 - (1 + 1 + 1) / 10.0);
  EXPECT_NEAR(counts.motp_m(), (5 * 0.01 + 4 * 0.03) / 9, 1e-12);
  // Object 1 agrees with track 1 in three frames (track 3 in two), object 2 with track 2 in four.
  EXPECT_EQ(counts.identity_matched, 7);
  EXPECT_DOUBLE_EQ(counts.idf1(), 2.0 * 7 / (10 + 10));
  // Every vertex is 1 cm (3 cm) from its own.
  EXPECT_NEAR(counts.adds_auc(), (5 * 0.9 + 4 * 0.7) / 10, 1e-6);
  EXPECT_EQ(counts.within_2cm, 5);
  EXPECT_EQ(counts.right, 5);
  EXPECT_EQ(report.total.right_at_end.hits, 1);
  EXPECT_EQ(report.total.right_at_end.total, 2);
  EXPECT_EQ(report.total.milliseconds_at(0.5), 3);
  EXPECT_EQ(report.total.milliseconds_at(0.99), 5);
  ASSERT_EQ(report.sequences.size(), 1u);
  EXPECT_EQ(report.sequences[0].visible.switches, 1);
}

// The pair of the frame before stays although another track is nearer.
TEST(Tracks, MatchesStayWhileTheyAreWithinTheLimit) {
  std::vector<io::BopFrame> frames;
  for (int i = 0; i < 2; ++i) frames.push_back(truth_frame(i, {instance(1, shifted(0))}));
  const TrackReport report =
      report_of(frames, {tracked(0, {track_at(1, shifted(0))}),
                         tracked(1, {track_at(2, shifted(0.001)), track_at(1, shifted(0.04))})});
  EXPECT_EQ(report.total.visible.switches, 0);
  EXPECT_EQ(report.total.visible.false_reports, 1);
}

TEST(Tracks, TwinsThatSwapTheirTracksSwitchTwice) {
  const Pose a = shifted(0), b = shifted(0.3);
  std::vector<io::BopFrame> frames;
  for (int i = 0; i < 4; ++i) frames.push_back(truth_frame(i, {instance(1, a), instance(2, b)}));
  std::vector<io::TrackResult> results;
  for (int i = 0; i < 4; ++i) {
    const bool swapped = i >= 2;
    results.push_back(tracked(i, {track_at(swapped ? 2 : 1, a), track_at(swapped ? 1 : 2, b)}));
  }
  const TrackCounts counts = report_of(frames, results).total.visible;
  EXPECT_EQ(counts.switches, 2);
  EXPECT_EQ(counts.identity_matched, 4);
  EXPECT_DOUBLE_EQ(counts.idf1(), 0.5);
  EXPECT_DOUBLE_EQ(counts.mota(), 1 - 2.0 / 8);
}

// Visible at 0 and 0.1 s, hidden from 0.2 to 1.9 s, visible at 2 s; the track is held until 1.4 s.
TEST(Tracks, HiddenObjectsCountForASecond) {
  std::vector<io::BopFrame> frames;
  std::vector<io::TrackResult> results;
  for (int i = 0; i <= 20; ++i) {
    const bool visible = i < 2 || i == 20;
    frames.push_back(truth_frame(i, {instance(1, shifted(0), visible ? 0.5 : 0.05)}));
    if (i < 2) results.push_back(tracked(i, {track_at(1, shifted(0))}));
    if (i >= 2 && i <= 14) {
      results.push_back(tracked(i, {track_at(1, shifted(0), TrackState::occluded)}));
    }
    if (i == 20) results.push_back(tracked(i, {track_at(7, shifted(0))}));
  }
  const TrackMeasures total = report_of(frames, results).total;
  EXPECT_EQ(total.visible.instances, 3);
  EXPECT_EQ(total.visible.matched, 3);
  EXPECT_EQ(total.visible.false_reports, 0);  // what is at a hidden object is not false
  EXPECT_EQ(total.visible.switches, 1);
  // Last seen at 0.1 s: hidden frames 2 to 11 count.
  EXPECT_EQ(total.all.instances, 13);
  EXPECT_EQ(total.all.matched, 13);
  EXPECT_EQ(total.all.false_reports, 0);
  EXPECT_EQ(total.hidden_held.hits, 10);
  EXPECT_EQ(total.hidden_held.total, 10);
}

TEST(Tracks, WhatIsTentativeOrLostIsNotReported) {
  const std::vector<io::BopFrame> frames = {truth_frame(0, {instance(1, shifted(0))})};
  const TrackMeasures total =
      report_of(frames, {tracked(0, {track_at(1, shifted(0), TrackState::tentative),
                                     track_at(2, shifted(0), TrackState::lost),
                                     track_at(3, shifted(3), TrackState::lost)})})
          .total;
  EXPECT_EQ(total.visible.matched, 0);
  EXPECT_EQ(total.visible.false_reports, 0);
  EXPECT_EQ(total.visible.mota(), 0);
}

TEST(Tracks, AnotherModelIsNoMatch) {
  const std::vector<io::BopFrame> frames = {truth_frame(0, {instance(1, shifted(0))})};
  const TrackCounts counts =
      report_of(frames, {tracked(0, {track_at(1, shifted(0), TrackState::confirmed, 2)})})
          .total.visible;
  EXPECT_EQ(counts.matched, 0);
  EXPECT_EQ(counts.false_reports, 1);
  EXPECT_EQ(counts.mota(), -1);
}

// In a fixed frame that is turned and moved against the camera, all is the same.
TEST(Tracks, TheFrameOfTheTracksDoesNotMatter) {
  const Pose frame_from_camera{rotation_from_vector({0.3, -0.8, 1.1}), {2, -1, 0.5}};
  const Pose truth{rotation_from_vector({0.1, 0.2, 0.3}), {0.1, 0.2, 0.9}};
  const Pose estimate{rotation_from_vector({0.1, 0.2, 0.35}), {0.11, 0.2, 0.9}};
  const std::vector<io::BopFrame> frames = {truth_frame(0, {instance(1, truth)})};
  const TrackMeasures in_camera = report_of(frames, {tracked(0, {track_at(1, estimate)})}).total;
  io::TrackResult fixed = tracked(0, {track_at(1, frame_from_camera * estimate)});
  fixed.in_fixed_frame = true;
  fixed.frame_from_camera = frame_from_camera;
  const TrackMeasures in_fixed = report_of(frames, {fixed}).total;
  EXPECT_NEAR(in_fixed.visible.motp_m(), 0.01, 1e-12);
  EXPECT_NEAR(in_fixed.visible.motp_m(), in_camera.visible.motp_m(), 1e-12);
  EXPECT_NEAR(in_fixed.visible.adds_area_sum, in_camera.visible.adds_area_sum, 1e-6);
  EXPECT_NEAR(in_fixed.nees(), in_camera.nees(), 1e-9);  // isotropic covariance
}

// Standard deviations of 1 cm and 0.01 rad: 2 cm and 0.02 rad off is 4 + 4 over 6 degrees of
// freedom; a turn about the axis of a solid of revolution does not count.
TEST(Tracks, NormalisedErrorSquaredByHand) {
  const Pose truth = shifted(0);
  const Pose estimate{rotation_from_vector({0.02, 0, 0}), {0.02, 0, 1}};
  const Pose spun{rotation_from_vector({0, 0, 2.0}), {0.02, 0, 1}};
  const std::vector<io::BopFrame> frames = {
      truth_frame(0, {instance(1, truth), instance(2, shifted(5), 1, 3)})};
  const Pose far_spun{spun.rotation, {5.04, 0, 1}};
  const TrackMeasures total =
      report_of(
          frames,
          {tracked(0, {track_at(1, estimate), track_at(2, far_spun, TrackState::confirmed, 3)})})
          .total;
  EXPECT_EQ(total.nees_within.total, 2);
  // 4 cm off is 16 over 5 degrees of freedom, beyond the 95 % quantile of 11.07.
  EXPECT_NEAR(total.nees(), 0.5 * (8.0 / 6 + 16.0 / 5), 1e-6);
  EXPECT_EQ(total.nees_within.hits, 1);
}

TEST(Tracks, SymmetricPosesAreRight) {
  const Pose turned{rotation_from_vector({0, 0, std::numbers::pi}), {0, 0, 1}};
  const std::vector<io::BopFrame> frames = {
      truth_frame(0, {instance(1, shifted(0), 1, 2), instance(2, shifted(1), 1, 1)})};
  const Pose turned_plain{turned.rotation, {1, 0, 1}};
  const TrackCounts counts =
      report_of(
          frames,
          {tracked(0, {track_at(1, turned, TrackState::confirmed, 2), track_at(2, turned_plain)})})
          .total.visible;
  EXPECT_EQ(counts.matched, 2);
  EXPECT_EQ(counts.right, 1);
  EXPECT_NEAR(counts.adds_auc(), 1, 1e-6);  // the square's corners fall on one another
}

TEST(Tracks, SequencesAreApart) {
  std::vector<io::BopFrame> frames;
  std::vector<io::TrackResult> results;
  for (const int scene : {1, 2}) {
    for (int i = 0; i < 2; ++i) {
      frames.push_back(truth_frame(i, {instance(1, shifted(0))}, scene));
      // The same object with another id in another sequence is no switch.
      results.push_back(tracked(i, {track_at(10 + scene, shifted(0))}, 1, scene));
    }
  }
  const TrackReport report = report_of(frames, results);
  ASSERT_EQ(report.sequences.size(), 2u);
  EXPECT_EQ(report.total.visible.switches, 0);
  EXPECT_EQ(report.total.visible.objects, 2);
  EXPECT_EQ(report.total.visible.idf1(), 1);
  EXPECT_EQ(report.total.frames, 4);
  const nlohmann::json json = nlohmann::json::parse(track_report_json(report));
  EXPECT_EQ(json.at("sequences").size(), 2u);
  EXPECT_EQ(json.at("total").at("visible").at("idf1"), 1.0);
  EXPECT_NE(track_report_text(report).find("total"), std::string::npos);
}

TEST(Tracks, AnyNumberOfThreadsGivesTheSame) {
  std::vector<io::BopFrame> frames;
  std::vector<io::TrackResult> results;
  for (int i = 0; i < 20; ++i) {
    frames.push_back(truth_frame(i, {instance(1, shifted(0.01 * i)), instance(2, shifted(1))}));
    results.push_back(tracked(i, {track_at(1 + i / 7, shifted(0.01 * i + 0.001 * (i % 5)))}));
  }
  TrackEvaluationOptions options;
  options.num_threads = 1;
  const std::string one = track_report_json(report_of(frames, results, options));
  options.num_threads = 2;
  EXPECT_EQ(one, track_report_json(report_of(frames, results, options)));
}

TEST(Tracks, WhatCannotBeComparedIsRefused) {
  const std::vector<io::BopFrame> frames = {truth_frame(0, {instance(1, shifted(0))})};
  const auto code = [&](const std::vector<io::BopFrame>& truth,
                        const std::vector<io::TrackResult>& results) {
    return evaluate_tracks(truth, square_objects(), results).status().code;
  };
  EXPECT_EQ(code(frames, {tracked(7, {})}), StatusCode::invalid_argument);
  EXPECT_EQ(code(frames, {tracked(0, {track_at(1, shifted(0), TrackState::confirmed, 99)})}),
            StatusCode::invalid_argument);
  EXPECT_EQ(code({truth_frame(0, {instance(0, shifted(0))})}, {}), StatusCode::invalid_argument);
  EXPECT_EQ(code({truth_frame(0, {instance(1, shifted(0)), instance(1, shifted(1))})}, {}),
            StatusCode::invalid_argument);
}

TEST(LinkedDetections, TakeTheNearestIdOfTheirModelWithinReach) {
  const auto found = [](int im_id, const std::vector<std::pair<int, double>>& placements) {
    io::FrameResult result;
    result.scene_id = 1;
    result.im_id = im_id;
    result.seconds = 0.5;
    result.interpretations.resize(1);
    for (const auto& [obj_id, x] : placements) {
      Placement& placement = result.interpretations[0].placements.emplace_back();
      placement.model_number = obj_id;
      placement.frame_from_object = shifted(x);
    }
    return result;
  };
  // Out of order, as a file may be.
  const std::vector<io::TrackResult> linked =
      linked_detections({found(2, {{1, 0.12}, {1, 0.54}}), found(0, {{1, 0}, {2, 0}}),
                         found(1, {{2, 0.02}, {1, 0.06}, {1, 0.45}})});
  ASSERT_EQ(linked.size(), 3u);
  const auto ids = [&](int frame) {
    std::vector<std::uint64_t> all;
    for (const Track& track : linked[frame].tracks) all.push_back(track.id);
    return all;
  };
  EXPECT_EQ(ids(0), (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(ids(1), (std::vector<std::uint64_t>{2, 1, 3}));
  EXPECT_EQ(ids(2), (std::vector<std::uint64_t>{1, 3}));
  EXPECT_EQ(linked[0].milliseconds, 500);
  EXPECT_EQ(linked[0].tracks[0].state, TrackState::confirmed);
}

}  // namespace
}  // namespace bpa::eval
