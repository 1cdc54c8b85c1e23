// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/tracker.hpp"

#include <gtest/gtest.h>

#include "tests/support/l_scene.hpp"

namespace bpa::track {
namespace {

using test::Solid;

constexpr double kPeriod_s = 1.0 / 30;  // between frames
constexpr float kNoise = 1;             // of the sensor's own

// Frames of a table with an L and bricks, at a quarter of the pixels: the map is as large.
class TrackerTest : public test::LScene {
 protected:
  static const ModelLibrary& models() {
    static const ModelLibrary library = [] {
      ModelLibrary out;
      EXPECT_TRUE(out.add(l_).ok());
      EXPECT_TRUE(out.add(brick_).ok());
      return out;
    }();
    return library;
  }
  static void TearDownTestSuite() {}

  static Tracker tracker(TrackerOptions options = {}) {
    return Tracker(std::make_shared<ModelLibrary>(models()), options);
  }

  std::shared_ptr<const Frame> frame(const std::vector<Solid>& solids) {
    ++number_;
    auto out = std::make_shared<Frame>(
        test::render(solids, test::kinect_camera(320), kNoise, number_).frame);
    out->stamp_ns = stamp();
    return out;
  }
  std::int64_t stamp() const {
    return 1'000'000'000 + static_cast<std::int64_t>(number_ * 1e9 * kPeriod_s);
  }
  double seconds() const { return number_ * kPeriod_s; }

  static std::vector<Solid> scene(const Pose& camera_from_world, const std::vector<Pose>& bricks) {
    std::vector<Solid> out = {test::table(camera_from_world)};
    for (const Pose& brick : bricks) out.push_back(test::brick_solid(camera_from_world * brick));
    return out;
  }
  static std::vector<Solid> scene(const std::vector<Pose>& bricks) {
    return scene(camera_from_world_, bricks);
  }
  static Pose brick_at(double x, double y, double angle = 0.2) {
    return test::standing_at(x, y, test::kBrickHalf.z(), angle);
  }

  // What a search finds: poses that are a little off.
  static SceneInterpretations found(std::int64_t stamp_ns, const std::vector<Pose>& poses,
                                    const std::string& model = "brick", double probability = 0.9) {
    SceneInterpretations out;
    out.stamp_ns = stamp_ns;
    out.sensor = "structured_light";
    Interpretation best;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Placement placement;
      placement.model = model;
      placement.probability = placement.presence = probability;
      placement.frame_from_object = test::disturbed(poses[i], 0.004, 0.03, i + 1);
      placement.covariance.diagonal() << 9e-6, 9e-6, 9e-6, 4e-4, 4e-4, 4e-4;
      best.placements.push_back(placement);
    }
    out.interpretations.push_back(best);
    return out;
  }

  static PoseError error(const Track& track, const Pose& frame_from_object) {
    return pose_error(track.frame_from_object, frame_from_object, brick_->symmetry);
  }
  static void expect_at(const Track& track, const Pose& frame_from_object) {
    EXPECT_LT(error(track, frame_from_object).position, 0.006);
    EXPECT_LT(error(track, frame_from_object).angle, 0.08);
  }

  // Follows one frame, and fails the test where that fails.
  static TrackedFrame follow(Tracker& tracker, std::shared_ptr<const Frame> frame,
                             const std::optional<CameraPose>& camera = {}) {
    auto out = tracker.track(std::move(frame), camera);
    EXPECT_TRUE(out.ok()) << out.status().message;
    return *out;
  }

  int number_ = 0;
};

TEST_F(TrackerTest, FindsOfASearchBecomeTracksThatStayWhereTheObjectsAre) {
  Tracker tracker = this->tracker();
  const std::vector<Pose> bricks = {brick_at(-0.15, 0), brick_at(0.12, 0.05)};
  const std::vector<Pose> seen = {camera_from_world_ * bricks[0], camera_from_world_ * bricks[1]};
  EXPECT_TRUE(follow(tracker, frame(scene(bricks))).tracks.empty());
  ASSERT_TRUE(tracker.add(found(stamp(), seen)).ok());
  TrackedFrame last;
  for (int i = 0; i < 20; ++i) {
    last = follow(tracker, frame(scene(bricks)));
    ASSERT_EQ(last.tracks.size(), 2u);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(last.tracks[k].id, k + 1u);
      EXPECT_EQ(last.tracks[k].name, k == 0 ? "brick_1" : "brick_2");
      EXPECT_EQ(last.tracks[k].state, TrackState::confirmed);
      expect_at(last.tracks[k], seen[k]);
    }
  }
  EXPECT_EQ(last.frame_id, "camera");
  EXPECT_FALSE(last.in_fixed_frame);
  EXPECT_EQ(last.tracks[0].velocity.norm(), 0);
  EXPECT_EQ(tracker.expected().size(), 2u);
  EXPECT_EQ(tracker.counts().births, 2u);
}

TEST_F(TrackerTest, MovingObjectIsFollowedThoughItsSearchIsLate) {
  Tracker tracker = this->tracker();
  const auto brick = [&] {  // 0.3 m/s and 60 degrees/s
    return brick_at(-0.3 + 0.3 * seconds(), 0, 0.2 + seconds());
  };
  SceneInterpretations result;
  TrackedFrame last;
  for (int i = 0; i < 60; ++i) {
    ++number_;  // the frame's
    const Pose at = brick();
    --number_;
    const auto image = frame(scene({at}));
    if (i == 10) result = found(stamp(), {camera_from_world_ * at});
    if (i == 25) {
      ASSERT_TRUE(tracker.add(result).ok());
    }
    last = follow(tracker, image);
    if (i < 30) continue;  // it catches up in a few frames
    ASSERT_EQ(last.tracks.size(), 1u) << i;
    EXPECT_LT(error(last.tracks[0], camera_from_world_ * at).position, 0.012) << i;
  }
  const Eigen::Vector3d velocity = camera_from_world_.rotation * Eigen::Vector3d(0.3, 0, 0);
  EXPECT_LT((last.tracks[0].velocity - velocity).norm(), 0.1);
  EXPECT_EQ(last.tracks[0].id, 1u);
}

TEST_F(TrackerTest, HiddenObjectIsOccludedAndKeepsItsName) {
  Tracker tracker = this->tracker();
  const Pose brick = brick_at(0, 0);
  follow(tracker, frame(scene({brick})));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * brick})).ok());
  follow(tracker, frame(scene({brick})));
  const Solid board{
      Solid::Kind::box, {0.2, 0.2, 0.01}, {Eigen::Quaterniond::Identity(), {0, 0, 0.45}}};
  for (int i = 0; i < 30; ++i) {
    const auto last = follow(tracker, frame(test::together(scene({brick}), {board})));
    ASSERT_EQ(last.tracks.size(), 1u);
    EXPECT_EQ(last.tracks[0].state, TrackState::occluded);
    expect_at(last.tracks[0], camera_from_world_ * brick);
    EXPECT_NEAR(last.tracks[0].unseen_s, (i + 1) * kPeriod_s, 1e-6);
  }
  const auto last = follow(tracker, frame(scene({brick})));
  EXPECT_EQ(last.tracks[0].state, TrackState::confirmed);
  EXPECT_EQ(last.tracks[0].id, 1u);
  EXPECT_EQ(tracker.counts().losses, 0u);
}

TEST_F(TrackerTest, RemovedObjectIsLostThenEndsUnlessHeld) {
  for (const bool held : {false, true}) {
    TrackerOptions options;
    options.lost_s = 0.5;
    Tracker tracker = this->tracker(options);
    const Pose brick = brick_at(0, 0);
    follow(tracker, frame(scene({brick})));
    ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * brick})).ok());
    follow(tracker, frame(scene({brick})));
    if (held) {
      ASSERT_TRUE(tracker.hold(1, true).ok());
    }
    int ended = 0, lost = 0;
    for (int i = 0; i < 20; ++i) {
      const auto last = follow(tracker, frame(scene(std::vector<Pose>())));
      ended += static_cast<int>(last.ended.size());
      for (const Track& track : last.tracks) lost += track.state == TrackState::lost;
      if (!last.ended.empty()) {
        EXPECT_EQ(last.ended[0].name, "brick_1");
        EXPECT_EQ(last.ended[0].reason, "not seen for 0.5 s");
      }
    }
    EXPECT_EQ(ended, held ? 0 : 1);
    EXPECT_GT(lost, 5);
    EXPECT_EQ(tracker.counts().losses, 1u);
  }
}

TEST_F(TrackerTest, LostObjectThatASearchFindsElsewhereKeepsItsName) {
  Tracker tracker = this->tracker();
  const Pose before = brick_at(-0.1, 0), after = brick_at(0.1, 0.1, 1.0);
  follow(tracker, frame(scene({before})));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * before})).ok());
  for (int i = 0; i < 5; ++i) follow(tracker, frame(scene({before})));
  for (int i = 0; i < 15; ++i) follow(tracker, frame(scene({after})));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * after})).ok());
  follow(tracker, frame(scene({after})));
  const auto last = follow(tracker, frame(scene({after})));
  ASSERT_EQ(last.tracks.size(), 1u);
  EXPECT_EQ(last.tracks[0].id, 1u);
  EXPECT_EQ(last.tracks[0].state, TrackState::confirmed);
  expect_at(last.tracks[0], camera_from_world_ * after);
}

TEST_F(TrackerTest, TwinsThatPassKeepTheirNames) {
  Tracker tracker = this->tracker();
  const auto bricks = [&] {  // toward each other at 0.3 m/s, 12 cm beside each other
    const double x = 0.3 - 0.3 * seconds();
    return std::vector{brick_at(-x, -0.06, 0), brick_at(x, 0.06, 0)};
  };
  TrackedFrame last;
  for (int i = 0; i < 60; ++i) {
    ++number_;
    const auto at = bricks();
    --number_;
    const auto image = frame(scene(at));
    last = follow(tracker, image);
    if (i == 0) {
      ASSERT_TRUE(
          tracker.add(found(stamp(), {camera_from_world_ * at[0], camera_from_world_ * at[1]}))
              .ok());
      continue;
    }
    ASSERT_EQ(last.tracks.size(), 2u) << i;
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(last.tracks[k].id, k + 1u);
      EXPECT_LT(error(last.tracks[k], camera_from_world_ * at[k]).position, 0.012) << i;
    }
  }
}

// One is carried past the other, between it and the camera: it hides it for a while.
TEST_F(TrackerTest, TwinThatHidesItsTwinTakesNoName) {
  Tracker tracker = this->tracker();
  const Pose standing = brick_at(0, 0, 0);
  const auto carried = [&] {  // 0.3 m/s, 12 cm nearer to the camera's side and 10 cm higher
    return test::standing_at(-0.3 + 0.3 * seconds(), -0.12, 0.1 + test::kBrickHalf.z(), 0);
  };
  int hidden = 0;
  for (int i = 0; i < 60; ++i) {
    ++number_;
    const Pose passing = carried();
    --number_;
    const auto last = follow(tracker, frame(scene({standing, passing})));
    if (i % 20 == 0) {
      ASSERT_TRUE(
          tracker.add(found(stamp(), {camera_from_world_ * standing, camera_from_world_ * passing}))
              .ok());
    }
    if (i < 2) continue;
    ASSERT_EQ(last.tracks.size(), 2u) << i;
    EXPECT_LT(error(last.tracks[0], camera_from_world_ * standing).position, 0.012) << i;
    EXPECT_LT(error(last.tracks[1], camera_from_world_ * passing).position, 0.012) << i;
    hidden += last.tracks[0].state == TrackState::occluded;
  }
  EXPECT_GT(hidden, 0);
}

TEST_F(TrackerTest, TracksStandStillInTheFixedFrameWhileTheCameraMoves) {
  Tracker tracker = this->tracker();
  const Pose brick = brick_at(0, 0);
  TrackedFrame last;
  for (int i = 0; i < 40; ++i) {  // about the brick, 20 degrees and 0.24 m in 1.3 s
    const double angle = -1.4 + 0.35 * i / 40;
    const Pose camera =
        test::look_at({0.7 * std::cos(angle), 0.7 * std::sin(angle), 0.5}, {0, 0, 0});
    last = follow(tracker, frame(scene(camera, {brick})), CameraPose{"world", camera.inverse()});
    if (i == 0) {
      ASSERT_TRUE(tracker.add(found(stamp(), {camera * brick})).ok());
    }
    if (i < 2) continue;
    ASSERT_EQ(last.tracks.size(), 1u);
    expect_at(last.tracks[0], brick);
  }
  EXPECT_EQ(last.frame_id, "world");
  EXPECT_TRUE(last.in_fixed_frame);
  EXPECT_LT(last.tracks[0].velocity.norm(), 0.02);
}

TEST_F(TrackerTest, PartOfAResultCountsWhereItIsSure) {
  Tracker tracker = this->tracker();
  const std::vector<Pose> bricks = {brick_at(-0.15, 0), brick_at(0.12, 0.05)};
  const Pose sure = camera_from_world_ * bricks[0], unsure = camera_from_world_ * bricks[1];
  follow(tracker, frame(scene(bricks)));
  const auto tell = [&](const Pose& pose, double probability, bool partial) {
    SceneInterpretations result = found(stamp(), {pose}, "brick", probability);
    result.partial = partial;
    ASSERT_TRUE(tracker.add(result).ok());
  };
  tell(unsure, 0.6, true);
  EXPECT_TRUE(follow(tracker, frame(scene(bricks))).tracks.empty());
  tell(sure, 0.9, true);
  EXPECT_EQ(follow(tracker, frame(scene(bricks))).tracks.size(), 1u);
  EXPECT_EQ(tracker.counts().searches, 0u);
  const auto before = follow(tracker, frame(scene(bricks)));
  SceneInterpretations empty = found(stamp(), {});
  empty.partial = true;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(tracker.add(empty).ok());
  }
  EXPECT_EQ(follow(tracker, frame(scene(bricks))).tracks[0].probability,
            before.tracks[0].probability);
}

TEST_F(TrackerTest, SurePartOfALaterResultConfirmsATrack) {
  for (const bool sure : {false, true}) {
    Tracker tracker = this->tracker();
    const Pose brick = brick_at(0, 0), there = camera_from_world_ * brick;
    follow(tracker, frame(scene({brick})));
    ASSERT_TRUE(tracker.add(found(stamp(), {there}, "brick", 0.6)).ok());
    const TrackedFrame born = follow(tracker, frame(scene({brick})));
    ASSERT_EQ(born.tracks.size(), 1u);
    EXPECT_EQ(born.tracks[0].state, TrackState::tentative);
    SceneInterpretations part = found(stamp(), {there}, "brick", sure ? 0.9 : 0.7);
    part.partial = true;
    ASSERT_TRUE(tracker.add(part).ok());
    follow(tracker, frame(scene({brick})));
    EXPECT_EQ(follow(tracker, frame(scene({brick}))).tracks[0].state,
              sure ? TrackState::confirmed : TrackState::tentative);
  }
}

TEST_F(TrackerTest, UnsurePartOfAResultFindsALostTrackAgain) {
  Tracker tracker = this->tracker();
  const Pose before = brick_at(-0.15, 0), after = brick_at(0.12, 0.05);
  follow(tracker, frame(scene({before})));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * before})).ok());
  const TrackedFrame born = follow(tracker, frame(scene({before})));
  ASSERT_EQ(born.tracks.size(), 1u);
  TrackedFrame last;
  for (int i = 0; i < 25; ++i) last = follow(tracker, frame(scene({after})));
  ASSERT_EQ(last.tracks.size(), 1u);
  ASSERT_EQ(last.tracks[0].state, TrackState::lost);
  SceneInterpretations part = found(stamp(), {camera_from_world_ * after}, "brick", 0.6);
  part.partial = true;
  ASSERT_TRUE(tracker.add(part).ok());
  follow(tracker, frame(scene({after})));
  last = follow(tracker, frame(scene({after})));
  ASSERT_EQ(last.tracks.size(), 1u);
  EXPECT_EQ(last.tracks[0].id, born.tracks[0].id);
  EXPECT_EQ(last.tracks[0].state, TrackState::confirmed);
  expect_at(last.tracks[0], camera_from_world_ * after);
}

TEST_F(TrackerTest, PartsAndWholeOfOneSearchCountOnce) {
  Tracker tracker = this->tracker();
  const Pose brick = brick_at(0, 0);
  follow(tracker, frame(scene({brick})));
  SceneInterpretations result = found(stamp(), {camera_from_world_ * brick});
  for (const bool partial : {true, true, false}) {
    result.partial = partial;
    ASSERT_TRUE(tracker.add(result).ok());
    const auto last = follow(tracker, frame(scene({brick})));
    ASSERT_EQ(last.tracks.size(), 1u);
    EXPECT_NEAR(last.tracks[0].probability, 0.9, 1e-9);
  }
}

TEST_F(TrackerTest, WhatSeemsToBeOfTheTableIsNoObject) {
  for (const bool there : {true, false}) {
    Tracker tracker = this->tracker();
    const Pose standing = brick_at(0, 0),
               sunk = test::standing_at(0, 0, -test::kBrickHalf.z(), 0.2);
    const std::vector<Pose> bricks = there ? std::vector{standing} : std::vector<Pose>();
    follow(tracker, frame(scene(bricks)));
    ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * (there ? standing : sunk)})).ok());
    EXPECT_EQ(follow(tracker, frame(scene(bricks))).tracks.size(), there ? 1u : 0u);
  }
}

TEST_F(TrackerTest, TrackIsWhereTwoSearchesFindItAlone) {
  Tracker tracker = this->tracker();
  const Pose wrong = brick_at(-0.15, 0), right = brick_at(0.12, 0.05);
  const std::vector<Pose> bricks = {wrong, right};
  follow(tracker, frame(scene(bricks)));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * wrong})).ok());
  follow(tracker, frame(scene(bricks)));
  for (const Pose& expected : {wrong, right}) {
    ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * right})).ok());
    const auto last = follow(tracker, frame(scene(bricks)));
    ASSERT_EQ(last.tracks.size(), 1u);
    EXPECT_EQ(last.tracks[0].id, 1u);
    expect_at(last.tracks[0], camera_from_world_ * expected);
  }
}

// A search that takes the L for its turned self: the view decides.
TEST_F(TrackerTest, WrongPoseGivesWayToTheAlternativeThatTheViewShows) {
  const Pose l = camera_from_world_ * test::standing_at(0, 0, 0.02, 0.7);
  const auto solids = test::together(table_only(), test::l_solids(l));
  const Pose half_turn{Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()};
  for (const bool own_is_right : {false, true}) {
    Tracker tracker = this->tracker();
    follow(tracker, frame(solids));
    SceneInterpretations result = found(stamp(), {own_is_right ? l : l * half_turn}, "l");
    result.interpretations[0].placements[0].alternatives = {
        {own_is_right ? l * half_turn : l, 0.4}};
    ASSERT_TRUE(tracker.add(result).ok());
    TrackedFrame last;
    for (int i = 0; i < 20; ++i) last = follow(tracker, frame(solids));
    ASSERT_EQ(last.tracks.size(), 1u);
    const PoseError wrong = pose_error(last.tracks[0].frame_from_object, l);
    EXPECT_LT(wrong.position, 0.01) << own_is_right;
    EXPECT_LT(wrong.angle, 0.1) << own_is_right;
    EXPECT_GT(last.tracks[0].weight, 0.9);
  }
}

TEST_F(TrackerTest, SameAnswerForAnyNumberOfThreads) {
  std::vector<std::vector<Pose>> answers;
  for (const int threads : {1, 2, 3}) {
    number_ = 0;
    TrackerOptions options;
    options.num_threads = threads;
    Tracker tracker = this->tracker(options);
    const std::vector<Pose> bricks = {brick_at(-0.15, 0), brick_at(0.12, 0.05)};
    std::vector<Pose>& answer = answers.emplace_back();
    for (int i = 0; i < 8; ++i) {
      const auto last = follow(tracker, frame(scene(bricks)));
      if (i == 0) {
        ASSERT_TRUE(tracker
                        .add(found(stamp(), {camera_from_world_ * bricks[0],
                                             camera_from_world_ * bricks[1]}))
                        .ok());
      }
      for (const Track& track : last.tracks) answer.push_back(track.frame_from_object);
    }
    ASSERT_EQ(answer.size(), 14u);
    for (std::size_t i = 0; i < answer.size(); ++i) {
      EXPECT_EQ(answer[i].translation, answers[0][i].translation);
      EXPECT_EQ(answer[i].rotation.coeffs(), answers[0][i].rotation.coeffs());
    }
  }
}

TEST_F(TrackerTest, RefusesWhatItCannotUse) {
  Tracker tracker = this->tracker();
  const auto first = frame(scene({brick_at(0, 0)}));
  follow(tracker, first);
  EXPECT_EQ(tracker.track(first).status().code, StatusCode::invalid_argument);
  EXPECT_EQ(tracker.add(found(5, {})).code, StatusCode::not_found);
  EXPECT_EQ(tracker.counts().stale_searches, 1u);
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * brick_at(0, 0)})).ok());
  follow(tracker, frame(scene({brick_at(0, 0)})));
  EXPECT_EQ(tracker.rename(7, "x").code, StatusCode::not_found);
  EXPECT_NE(tracker.rename(7, "x").message.find("1 (brick_1)"), std::string::npos);
  EXPECT_EQ(tracker.rename(1, "").code, StatusCode::invalid_argument);
  EXPECT_TRUE(tracker.rename(1, "lid").ok());
  EXPECT_TRUE(tracker.forget(1).ok());
  const auto last = follow(tracker, frame(scene({brick_at(0, 0)})));
  EXPECT_TRUE(last.tracks.empty());
  ASSERT_EQ(last.ended.size(), 1u);
  EXPECT_EQ(last.ended[0].name, "lid");
}

TEST_F(TrackerTest, KnowsWhatHasChangedSinceAFrame) {
  Tracker tracker = this->tracker();
  follow(tracker, frame(scene({brick_at(0, 0)})));
  const std::int64_t first = stamp();
  follow(tracker, frame(scene({brick_at(0, 0)})));
  EXPECT_LT(tracker.changed_since(first), 0.005);
  follow(tracker, frame(scene({brick_at(0.1, 0)})));
  EXPECT_GT(tracker.changed_since(first), 0.01);
  EXPECT_EQ(tracker.changed_since(first + 1), 1);
}

TEST_F(TrackerTest, WhatSearchesNoLongerFindEnds) {
  Tracker tracker = this->tracker();
  const Pose brick = brick_at(0, 0);
  follow(tracker, frame(scene({brick})));
  ASSERT_TRUE(tracker.add(found(stamp(), {camera_from_world_ * brick}, "brick", 0.6)).ok());
  std::string reason;
  for (int i = 0; i < 6 && reason.empty(); ++i) {
    const auto last = follow(tracker, frame(scene({brick})));
    if (!last.ended.empty()) reason = last.ended[0].reason;
    ASSERT_TRUE(tracker.add(found(stamp(), {})).ok());
  }
  EXPECT_EQ(reason, "searches do not find it");
}

}  // namespace
}  // namespace bpa::track
