// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "core/sim/arms.hpp"
#include "core/sim/motion.hpp"

namespace bpa::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const Stage& moving_stage() {
  static const Stage the_stage =
      sequence_stage(household_objects({"mug", "milk_carton", "can", "gear", "cube", "l_brick"}));
  return the_stage;
}

SequenceOptions few_objects(SequenceKind kind) {
  SequenceOptions options;
  options.kind = kind;
  options.seconds = 10;
  options.min_objects = options.max_objects = 4;
  options.max_distractors = 1;
  options.camera = {160, 120, 131.25, 131.25, 79.5, 59.5};
  options.sensor.kinect.registered = false;
  return options;
}

Sequence planned(const SequenceOptions& options, std::uint64_t seed) {
  Result<Sequence> sequence = plan_sequence(moving_stage(), options, seed);
  EXPECT_TRUE(sequence.ok()) << sequence.status().message;
  return std::move(*sequence);
}

// The largest speeds of a pose over the frames, by finite differences.
struct FastestMotion {
  double linear = 0, angular = 0;
};

FastestMotion fastest(const Sequence& sequence, const auto& pose_of) {
  FastestMotion motion;
  for (std::size_t i = 1; i < sequence.frames.size(); ++i) {
    const double seconds =
        1e-9 * double(sequence.frames[i].stamp_ns - sequence.frames[i - 1].stamp_ns);
    const PoseError change =
        pose_error(pose_of(sequence.frames[i - 1]), pose_of(sequence.frames[i]));
    motion.linear = std::max(motion.linear, change.position / seconds);
    motion.angular = std::max(motion.angular, change.angle / seconds);
  }
  return motion;
}

FastestMotion fastest_camera(const Sequence& sequence) {
  return fastest(sequence, [](const SequenceFrame& frame) { return frame.world_from_camera; });
}

FastestMotion fastest_body(const Sequence& sequence, std::size_t body) {
  return fastest(sequence,
                 [body](const SequenceFrame& frame) { return frame.bodies[body].world_from_mesh; });
}

bool moved(const Sequence& sequence, std::size_t body) {
  const FastestMotion motion = fastest_body(sequence, body);
  return motion.linear + motion.angular > 1e-6;
}

bool is_arm(const PosedMesh& body) {
  const int all = moving_stage().meshes().size();
  return body.mesh >= all - kNumArms;
}

double lowest(const PosedMesh& body) {
  double z = 1e9;
  for (const Eigen::Vector3f& v : moving_stage().meshes().mesh(body.mesh).vertices) {
    z = std::min(z, (body.world_from_mesh * v.cast<double>()).z());
  }
  return z;
}

class SequenceOf : public ::testing::TestWithParam<SequenceKind> {};

TEST_P(SequenceOf, KeepsTheLimitsOfSpeed) {
  SequenceOptions options = few_objects(GetParam());
  options.rate = 100;
  const Sequence sequence = planned(options, 5);
  const FastestMotion camera = fastest_camera(sequence);
  // Chords are shorter than arcs; seconds_of() measures in other steps.
  EXPECT_LE(camera.linear, 1.02 * options.camera_speed);
  EXPECT_LE(camera.angular, 1.02 * kDegree * options.camera_turn_deg);
  for (std::size_t i = 0; i < sequence.objects.size(); ++i) {
    const FastestMotion object = fastest_body(sequence, i);
    EXPECT_LE(object.linear, 1.02 * options.object_speed) << i;
    EXPECT_LE(object.angular, 1.02 * kDegree * options.object_turn_deg) << i;
  }
}

TEST_P(SequenceOf, HasTheEventsOfItsKind) {
  const SequenceKind kind = GetParam();
  const Sequence sequence = planned(few_objects(kind), 6);
  std::map<SequenceKind, int> events;
  for (const SequenceEvent& event : sequence.events) ++events[event.kind];
  const bool camera_moves = kind != SequenceKind::standing;
  EXPECT_EQ(fastest_camera(sequence).linear > 0.02, camera_moves);
  const bool none = kind == SequenceKind::standing || kind == SequenceKind::moving_camera;
  EXPECT_EQ(events.empty(), none);
  if (kind == SequenceKind::mixed) {
    EXPECT_GE(events.size(), 2u);
  } else if (!none) {
    EXPECT_GE(events[kind], 1);
  }
  std::size_t moving = 0;
  for (std::size_t i = 0; i < sequence.objects.size(); ++i) moving += moved(sequence, i);
  const bool touched = !none && kind != SequenceKind::occluded;
  EXPECT_EQ(moving > 0, touched);
}

TEST_P(SequenceOf, StandsOnTheTableBeforeAndAfterEachEvent) {
  const SequenceOptions options = few_objects(GetParam());
  const Sequence sequence = planned(options, 8);
  const auto check = [&](double seconds) {
    const auto frame = static_cast<std::size_t>(std::lround(seconds * options.rate));
    if (frame >= sequence.frames.size()) return;
    for (std::size_t i = 0; i < sequence.objects.size(); ++i) {
      EXPECT_NEAR(lowest(sequence.frames[frame].bodies[i]), 0, 0.002) << i << " at " << seconds;
    }
  };
  check(0);
  for (const SequenceEvent& event : sequence.events) {
    if (event.kind == SequenceKind::picked) continue;
    check(event.start - 0.05);
    check(event.end + 0.05);
  }
  for (const SequenceEvent& event : sequence.events) check(event.end + 0.05);
}

INSTANTIATE_TEST_SUITE_P(All, SequenceOf, ::testing::ValuesIn(kSequenceKinds),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST(Sequences, BodiesOnTheTableDoNotTouch) {
  const SequenceOptions options = few_objects(SequenceKind::pushed);
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Sequence sequence = planned(options, seed);
    for (std::size_t f = 0; f < sequence.frames.size(); f += 15) {
      const auto& bodies = sequence.frames[f].bodies;
      for (std::size_t a = 0; a < sequence.objects.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          double nearest = 1e9;
          const TriangleMesh& mesh_a = moving_stage().meshes().mesh(bodies[a].mesh);
          const TriangleMesh& mesh_b = moving_stage().meshes().mesh(bodies[b].mesh);
          for (std::size_t i = 0; i < mesh_a.vertices.size(); i += 97) {
            const Eigen::Vector3d p = bodies[a].world_from_mesh * mesh_a.vertices[i].cast<double>();
            for (std::size_t k = 0; k < mesh_b.vertices.size(); k += 97) {
              const Eigen::Vector3d q =
                  bodies[b].world_from_mesh * mesh_b.vertices[k].cast<double>();
              nearest = std::min(nearest, (p - q).norm());
            }
          }
          EXPECT_GT(nearest, 0.008) << a << " and " << b << " in frame " << f;
        }
      }
    }
  }
}

TEST(Sequences, ACarriedObjectRisesAndItsHandStaysAtIt) {
  const Sequence sequence = planned(few_objects(SequenceKind::picked), 2);
  ASSERT_FALSE(sequence.events.empty());
  const SequenceEvent& event = sequence.events.front();
  double highest = 0;
  Eigen::Vector3d first_offset = Eigen::Vector3d::Zero();
  for (const SequenceFrame& frame : sequence.frames) {
    const double t = 1e-9 * double(frame.stamp_ns);
    if (t < event.start || t > event.end) continue;
    const PosedMesh& held = frame.bodies[event.instance];
    highest = std::max(highest, lowest(held));
    const auto hand = std::ranges::find_if(frame.bodies, is_arm);
    ASSERT_NE(hand, frame.bodies.end());
    const Eigen::Vector3d offset =
        held.world_from_mesh.inverse() * hand->world_from_mesh.translation;
    if (first_offset.isZero()) first_offset = offset;
    EXPECT_LT((offset - first_offset).norm(), 1e-9);
  }
  EXPECT_GT(highest, 0.08);
}

TEST(Sequences, TwinsAreOfOneModelAndChangePlaces) {
  const Sequence sequence = planned(few_objects(SequenceKind::twins), 3);
  ASSERT_FALSE(sequence.events.empty());
  const SequenceEvent& event = sequence.events.front();
  const int a = event.instance, b = a + 1;
  EXPECT_EQ(sequence.objects[a], sequence.objects[b]);
  const auto at = [&](double seconds, int body) {
    const auto frame = static_cast<std::size_t>(std::lround(30 * seconds));
    return sequence.frames.at(frame).bodies[body].world_from_mesh.translation;
  };
  for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
    // The origin is not the centre of the covering circle: each keeps its own turn.
    EXPECT_LT((at(event.start - 0.05, one) - at(event.end + 0.05, other)).norm(), 0.03);
  }
}

TEST(Sequences, AnArmHidesAnObjectForAtMostASecond) {
  SequenceOptions options = few_objects(SequenceKind::occluded);
  options.max_distractors = 0;
  options.drop = 0;
  options.seconds = 4;
  options.camera_speed = options.camera_turn_deg = 0;
  int hidden_by_arm = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Sequence sequence = planned(options, seed);
    ASSERT_FALSE(sequence.events.empty());
    const int body = sequence.events.front().instance;
    int run = 0, longest = 0;
    for (std::size_t f = 0; f < sequence.frames.size(); f += 2) {
      const RayScene scene(moving_stage().meshes(), sequence.frames[f].bodies);
      const RenderedImage image =
          render(scene, options.camera, sequence.frames[f].world_from_camera, std::nullopt, 2);
      const auto seen = std::ranges::count(image.instance, body);
      run = seen == 0 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
    hidden_by_arm += longest > 0;
    EXPECT_LE(2 * longest, 1.05 * options.rate);
  }
  EXPECT_GE(hidden_by_arm, 2);
}

TEST(Sequences, AHandleComesIntoView) {
  SequenceOptions options = few_objects(SequenceKind::handle);
  options.min_objects = options.max_objects = 1;
  options.max_distractors = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Sequence sequence = planned(options, seed);
    const SimulatedObject& mug = moving_stage().objects()[sequence.objects[0]];
    EXPECT_EQ(mug.name, "mug");
    // Counted by another way than the planner's: pixels beyond the wall, as in scenes_test.cpp.
    constexpr double kAxisX = -0.0164, kWallRadius = 0.0435;  // metres, in the mug's frame
    const auto handle_pixels = [&](int frame) {
      const SequenceFrame& at = sequence.frames[frame];
      const RayScene scene(moving_stage().meshes(), at.bodies);
      const RenderedImage image = render(scene, options.camera, at.world_from_camera, std::nullopt);
      const Pose mug_from_camera = at.bodies[0].world_from_mesh.inverse() * at.world_from_camera;
      int pixels = 0;
      for (int p = 0; p < options.camera.width * options.camera.height; ++p) {
        if (image.instance[p] != 0) continue;
        const Eigen::Vector3d point =
            mug_from_camera * options.camera.unproject(p % options.camera.width,
                                                       p / options.camera.width, image.depth[p]);
        pixels += std::hypot(point.x() - kAxisX, point.y()) > kWallRadius;
      }
      return pixels;
    };
    EXPECT_LE(handle_pixels(0), 3);
    EXPECT_LE(handle_pixels(60), 3);
    ASSERT_EQ(sequence.events.front().kind, SequenceKind::handle);
    EXPECT_GT(handle_pixels(static_cast<int>(30 * (sequence.events.front().end + 0.95))), 5);
  }
}

TEST(Sequences, DropsSomeFramesButNotTheFirst) {
  SequenceOptions options = few_objects(SequenceKind::standing);
  options.seconds = 20;
  options.drop = 0.1;
  int dropped = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Sequence sequence = planned(options, seed);
    ASSERT_EQ(sequence.frames.size(), 600u);
    EXPECT_FALSE(sequence.frames.front().dropped);
    dropped += static_cast<int>(std::ranges::count(sequence.frames, true, &SequenceFrame::dropped));
  }
  EXPECT_NEAR(dropped, 300, 66);  // four standard deviations of 3000 draws
  EXPECT_EQ(planned(options, 0).frames[31].stamp_ns, 1'033'333'333);
}

TEST(Sequences, FramesAreTheSameForAnyNumberOfThreads) {
  SequenceOptions options = few_objects(SequenceKind::mixed);
  const Sequence one = planned(options, 4), two = planned(options, 4);
  for (const int frame : {0, 60}) {
    const SimulatedFrame a = capture_frame(moving_stage(), one, frame, 1);
    const SimulatedFrame b = capture_frame(moving_stage(), two, frame, 2);
    EXPECT_EQ(a.frame.stamp_ns, b.frame.stamp_ns);
    EXPECT_EQ(a.frame.depth, b.frame.depth);
    EXPECT_EQ(a.frame.color, b.frame.color);
    EXPECT_EQ(a.instance_image, b.instance_image);
    ASSERT_EQ(a.instances.size(), one.objects.size());
    for (std::size_t i = 0; i < a.instances.size(); ++i) {
      EXPECT_EQ(a.instances[i].camera_from_object.translation,
                b.instances[i].camera_from_object.translation);
      // The mask and the visible fraction are about the same pixels.
      const std::vector<std::uint8_t> mask = visible_mask(a, static_cast<int>(i));
      EXPECT_EQ(std::ranges::count(mask, 255), a.instances[i].visibility.visible_pixels);
    }
  }
  const Sequence other = planned(options, 9);
  EXPECT_NE(one.frames[30].world_from_camera.translation,
            other.frames[30].world_from_camera.translation);
}

// What a mask calls an instance lies at the depth of that instance's mesh alone.
TEST(Sequences, MasksAgreeWithTheDepthOfEachInstance) {
  const SequenceOptions options = few_objects(SequenceKind::picked);
  const Sequence sequence = planned(options, 2);
  const int frame =
      static_cast<int>(30 * 0.5 * (sequence.events.front().start + sequence.events.front().end));
  const SimulatedFrame captured = capture_frame(moving_stage(), sequence, frame);
  for (std::size_t i = 0; i < captured.instances.size(); ++i) {
    const RayScene alone(moving_stage().meshes(),
                         {{sequence.objects[i], captured.instances[i].camera_from_object}});
    const RenderedImage image = render(alone, options.camera, Pose{}, std::nullopt);
    int wrong = 0, seen = 0;
    for (std::size_t p = 0; p < image.depth.size(); ++p) {
      if (captured.instance_image[p] != static_cast<int>(i)) continue;
      ++seen;
      wrong += std::abs(image.depth[p] - captured.ideal_depth[p]) > 1e-3;
    }
    EXPECT_LE(wrong, 2 + seen / 100) << i;
  }
}

TEST(Sequences, WrongOptionsAreNamed) {
  SequenceOptions options = few_objects(SequenceKind::handle);
  const Stage cubes = sequence_stage(household_objects(std::vector<std::string>{"cube"}));
  EXPECT_EQ(plan_sequence(cubes, options, 1).status().code, StatusCode::invalid_argument);
  options.kind = SequenceKind::mixed;
  options.seconds = -1;
  EXPECT_NE(plan_sequence(moving_stage(), options, 1).status().message.find("seconds"),
            std::string::npos);
  options.seconds = 1;
  options.min_objects = 5;
  EXPECT_NE(plan_sequence(moving_stage(), options, 1).status().message.find("min_objects"),
            std::string::npos);
}

TEST(Motion, MinimumJerkBeginsAndEndsAtRest) {
  EXPECT_EQ(smooth_start_and_stop(-1), 0);
  EXPECT_EQ(smooth_start_and_stop(0.5), 0.5);
  EXPECT_EQ(smooth_start_and_stop(2), 1);
  EXPECT_EQ(smooth_bump(0.5), 1);
  constexpr double kStep = 1e-4;
  for (const auto& f : {smooth_start_and_stop, smooth_bump}) {
    for (const double end : {0.0, 1.0}) {
      EXPECT_NEAR((f(end + kStep) - f(end - kStep)) / kStep, 0, 1e-6);
    }
  }
}

// The largest speed of minimum jerk is 15/8 of the mean: its derivative half way.
TEST(Motion, TimeOfAStraightPathInClosedForm) {
  const PosePath path = [](double u) {
    return Pose{Eigen::Quaterniond::Identity(), {0.4 * smooth_start_and_stop(u), 0, 0}};
  };
  EXPECT_NEAR(seconds_of(path, {0.5, 1}), 15.0 / 8 * 0.4 / 0.5, 1e-3);
}

}  // namespace
}  // namespace bpa::sim
