// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tf_buffer.hpp"

#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/time.hpp"

namespace bpa::server {
namespace {

using std::chrono::milliseconds;
using wire::geometry_msgs::TransformStamped;

constexpr std::int64_t kSecond = 1'000'000'000;

TransformStamped transform(const std::string& parent, const std::string& child,
                           std::int64_t stamp_ns, const Eigen::Vector3d& at,
                           double angle_about_z = 0) {
  TransformStamped message;
  message.header = {wire::builtin_interfaces::from_ns(stamp_ns), parent};
  message.child_frame_id = child;
  message.transform.translation = {at.x(), at.y(), at.z()};
  message.transform.rotation = {0, 0, std::sin(angle_about_z / 2), std::cos(angle_about_z / 2)};
  return message;
}

void expect_pose(const Result<Pose>& pose, const Eigen::Vector3d& at, double angle_about_z) {
  ASSERT_TRUE(pose.ok()) << pose.status().message;
  EXPECT_LT((pose->translation - at).norm(), 1e-12) << pose->translation.transpose();
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle_about_z, Eigen::Vector3d::UnitZ()));
  EXPECT_LT(rotation_angle(pose->rotation, expected), 1e-7);
}

TEST(TfBuffer, InterpolatesAlongTheLineAndTheArc) {
  TfBuffer buffer(10);
  buffer.add(transform("map", "camera", 1 * kSecond, {0, 0, 1}, 0), false);
  buffer.add(transform("map", "camera", 2 * kSecond, {1, 2, 1}, 1.2), false);
  for (const double part : {0.0, 0.25, 0.5, 1.0}) {
    const auto stamp = kSecond + static_cast<std::int64_t>(part * 1e9);
    expect_pose(buffer.lookup("map", "camera", stamp), {part, 2 * part, 1}, 1.2 * part);
    // The other way round it is the inverse.
    const Result<Pose> back = buffer.lookup("camera", "map", stamp);
    ASSERT_TRUE(back.ok());
    expect_pose(back->inverse(), {part, 2 * part, 1}, 1.2 * part);
  }
}

TEST(TfBuffer, DoesNotExtrapolate) {
  TfBuffer buffer(10);
  buffer.add(transform("map", "camera", 1 * kSecond, {0, 0, 0}), false);
  buffer.add(transform("map", "camera", 2 * kSecond, {1, 0, 0}), false);
  for (const std::int64_t stamp : {kSecond - 1, 2 * kSecond + 1}) {
    const Status status = buffer.lookup("map", "camera", stamp).status();
    EXPECT_EQ(status.code, StatusCode::unavailable);
    EXPECT_NE(status.message.find("camera"), std::string::npos);
  }
  EXPECT_EQ(buffer.lookup("map", "gripper", kSecond).status().code, StatusCode::not_found);
}

TEST(TfBuffer, ChainsMovingAndStaticFramesThroughTheirCommonAncestor) {
  TfBuffer buffer(10);
  buffer.add(transform("base", "map_marker", 0, {5, 0, 0}), true);
  buffer.add(transform("/base", "/hand", 1 * kSecond, {1, 0, 0}, 0.5), false);
  buffer.add(transform("base", "hand", 3 * kSecond, {1, 0, 0}, 1.5), false);
  buffer.add(transform("hand", "camera", 0, {0, 0, 0.1}), true);  // static: at any time
  expect_pose(buffer.lookup("base", "camera", 2 * kSecond), {1, 0, 0.1}, 1.0);
  expect_pose(buffer.lookup("map_marker", "camera", 2 * kSecond), {-4, 0, 0.1}, 1.0);
  expect_pose(buffer.lookup("camera", "camera", 17), {0, 0, 0}, 0);
  EXPECT_TRUE(buffer.knows("base"));
  EXPECT_TRUE(buffer.knows("camera"));
  EXPECT_FALSE(buffer.knows("mug_1"));
}

TEST(TfBuffer, SamplesMayComeInAnyOrder) {
  TfBuffer buffer(10);
  for (const int stamp : {3, 1, 4, 2}) {
    buffer.add(transform("map", "camera", stamp * kSecond, {1.0 * stamp * stamp, 0, 0}), false);
  }
  expect_pose(buffer.lookup("map", "camera", 3 * kSecond / 2), {2.5, 0, 0}, 0);
  expect_pose(buffer.lookup("map", "camera", 7 * kSecond / 2), {12.5, 0, 0}, 0);
}

TEST(TfBuffer, RefusesAndCountsWhatIsNoTransform) {
  TfBuffer buffer(10);
  TransformStamped bad = transform("map", "camera", kSecond, {0, 0, 0});
  bad.transform.rotation = {0, 0, 0, 0};
  buffer.add(bad, false);
  bad.transform.rotation = {0, 0, 0, 1.05};
  buffer.add(bad, false);
  bad.transform.rotation = {0, 0, 0, std::numeric_limits<double>::quiet_NaN()};
  buffer.add(bad, false);
  buffer.add(transform("map", "camera", kSecond, {std::numeric_limits<double>::infinity(), 0, 0}),
             false);
  buffer.add(transform("", "camera", kSecond, {0, 0, 0}), false);
  buffer.add(transform("map", "/", kSecond, {0, 0, 0}), false);
  buffer.add(transform("map", std::string(300, 'a'), kSecond, {0, 0, 0}), false);
  EXPECT_EQ(buffer.counts().bad, 7U);
  EXPECT_EQ(buffer.frames(), 0U);
  bad.transform.rotation = {0, 0, 0, 1.001};  // as numbers of single precision may be
  buffer.add(bad, false);
  EXPECT_EQ(buffer.counts().taken, 1U);
  const Result<Pose> pose = buffer.lookup("map", "camera", kSecond);
  ASSERT_TRUE(pose.ok());
  EXPECT_TRUE(is_valid(*pose));
}

TEST(TfBuffer, RefusesLoops) {
  TfBuffer buffer(10);
  buffer.add(transform("a", "a", kSecond, {0, 0, 0}), false);
  buffer.add(transform("a", "b", kSecond, {0, 0, 0}), false);
  buffer.add(transform("b", "c", kSecond, {0, 0, 0}), true);
  buffer.add(transform("c", "a", kSecond, {0, 0, 0}), false);
  EXPECT_EQ(buffer.counts().loops, 2U);
  // A frame may change its parent, and what was above it may then be below; old stamps know both.
  buffer.add(transform("x", "b", 2 * kSecond, {0, 0, 0}), false);
  buffer.add(transform("c", "a", 2 * kSecond, {0, 0, 0}), false);
  EXPECT_EQ(buffer.counts().loops, 2U);
  EXPECT_TRUE(buffer.lookup("x", "a", 2 * kSecond).ok());
}

TEST(TfBuffer, RemembersNoMoreThanItMay) {
  TfBuffer buffer(2);
  for (int i = 0; i <= 100; ++i) {
    buffer.add(transform("map", "camera", i * kSecond / 10, {0.1 * i, 0, 0}), false);
  }
  EXPECT_TRUE(buffer.lookup("map", "camera", 8 * kSecond).ok());
  EXPECT_FALSE(buffer.lookup("map", "camera", 8 * kSecond - 1).ok());
  TfBuffer many(60);
  for (std::size_t i = 0; i < TfBuffer::kMaxFrames + 10; ++i) {
    many.add(transform("map", "frame" + std::to_string(i), kSecond, {0, 0, 0}), false);
  }
  EXPECT_EQ(many.frames(), TfBuffer::kMaxFrames);
  EXPECT_EQ(many.counts().full, 10U);
  for (std::size_t i = 0; i < TfBuffer::kMaxSamples + 10; ++i) {
    many.add(transform("map", "frame0", kSecond + static_cast<std::int64_t>(i), {0, 0, 0}), false);
  }
  EXPECT_FALSE(many.lookup("map", "frame0", kSecond + 9).ok());
  EXPECT_TRUE(many.lookup("map", "frame0", kSecond + 10).ok());
}

TEST(TfBuffer, AClockThatIsSetBackBeginsAnew) {
  TfBuffer buffer(5);
  buffer.add(transform("map", "camera", 100 * kSecond, {1, 0, 0}), false);
  buffer.add(transform("map", "camera", 1 * kSecond, {2, 0, 0}), false);
  EXPECT_EQ(buffer.counts().restarts, 1U);
  expect_pose(buffer.lookup("map", "camera", 1 * kSecond), {2, 0, 0}, 0);
  EXPECT_FALSE(buffer.lookup("map", "camera", 100 * kSecond).ok());
}

TEST(TfBuffer, WaitsForALateTransform) {
  TfBuffer buffer(10);
  buffer.add(transform("map", "camera", 1 * kSecond, {0, 0, 0}), false);
  std::jthread late([&](const std::stop_token&) {
    std::this_thread::sleep_for(milliseconds(30));
    buffer.add(transform("map", "camera", 2 * kSecond, {1, 0, 0}), false);
  });
  expect_pose(buffer.wait_for("map", "camera", 3 * kSecond / 2, std::chrono::seconds(20), {}),
              {0.5, 0, 0}, 0);
  EXPECT_EQ(buffer.wait_for("map", "camera", 5 * kSecond, milliseconds(5), {}).status().code,
            StatusCode::unavailable);
  std::stop_source stop;
  std::jthread stopper([&](const std::stop_token&) { stop.request_stop(); });
  EXPECT_FALSE(
      buffer.wait_for("map", "camera", 5 * kSecond, std::chrono::hours(1), stop.get_token()).ok());
}

}  // namespace
}  // namespace bpa::server
