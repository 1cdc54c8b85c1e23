// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/motion_filter.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa::track {
namespace {

constexpr double kFrame_s = 1.0 / 30;

Matrix6d diagonal(double position, double angle) {
  Matrix6d out = Matrix6d::Zero();
  out.diagonal() << Eigen::Vector3d::Constant(position * position),
      Eigen::Vector3d::Constant(angle * angle);
  return out;
}

// What a camera is off by: half of the variance in every frame alike, half anew.
class Measured {
 public:
  Measured(const Matrix6d& covariance, std::uint64_t seed)
      : covariance_(covariance), random_(seed, 77), common_(draw()) {}

  UncertainPose of(const Pose& truth) { return {moved(truth, common_ + draw()), covariance_}; }

 private:
  Vector6d draw() {
    Vector6d out;
    for (int i = 0; i < 6; ++i) out[i] = std::sqrt(0.5 * covariance_(i, i)) * random_.normal();
    return out;
  }

  Matrix6d covariance_;
  RandomStream random_;
  Vector6d common_;
};

double error_squared(const MotionFilter& filter, const Pose& truth) {
  const Vector6d error = difference(truth, filter.pose());
  return error.dot(Vector6d(filter.covariance().inverse() * error));
}

const Pose kStart{rotation_from_vector({0.3, -0.8, 0.5}), {0.1, -0.2, 0.8}};

TEST(Difference, IsUndoneByMoved) {
  const Pose other{rotation_from_vector({-0.4, 0.2, 1.1}), {0.3, 0.1, 0.7}};
  const Pose back = moved(kStart, difference(other, kStart));
  EXPECT_LT((back.translation - other.translation).norm(), 1e-12);
  EXPECT_LT(rotation_angle(back.rotation, other.rotation), 1e-12);
}

// The mean of the normalised squared error of 400 runs with 6 degrees of freedom has a standard
// deviation of sqrt(12 / 400).
TEST(MotionFilter, ErrorsOfARestingObjectAreThoseOfItsCovariance) {
  constexpr int kRuns = 400;
  double sum = 0;
  for (int run = 0; run < kRuns; ++run) {
    Measured measured(diagonal(0.002, 0.02), run);
    MotionFilter filter(measured.of(kStart));
    for (int i = 0; i < 30; ++i) {
      filter.predict(kFrame_s, true);
      filter.update(measured.of(kStart));
    }
    sum += error_squared(filter, kStart);
  }
  const double deviation = std::sqrt(12.0 / kRuns);
  EXPECT_NEAR(sum / kRuns, 6, 3 * deviation + 0.5);  // drift is allowed for and does not happen
}

TEST(MotionFilter, RestingObjectIsSaidToRest) {
  Measured measured(diagonal(0.002, 0.02), 3);
  MotionFilter filter(measured.of(kStart));
  for (int i = 0; i < 300; ++i) {
    filter.predict(kFrame_s, true);
    filter.update(measured.of(kStart));
  }
  EXPECT_FALSE(filter.moves());
  EXPECT_EQ(filter.velocity().norm(), 0);
}

Pose at(const Vector6d& velocity, double seconds) { return moved(kStart, velocity * seconds); }

TEST(MotionFilter, FollowsConstantVelocityWithoutDelay) {
  Vector6d velocity;
  velocity << 0.4, -0.2, 0.1, 0, 0, 1.5;
  constexpr int kRuns = 200, kFrames = 60;
  double sum = 0;
  Vector6d mean = Vector6d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    Measured measured(diagonal(0.002, 0.02), 1000 + run);
    MotionFilter filter(measured.of(kStart));
    for (int i = 1; i <= kFrames; ++i) {
      filter.predict(kFrame_s, true);
      filter.update(measured.of(at(velocity, i * kFrame_s)));
    }
    ASSERT_TRUE(filter.moves());
    sum += error_squared(filter, at(velocity, kFrames * kFrame_s));
    mean.head<3>() += filter.velocity() / kRuns;
    mean.tail<3>() += filter.angular_velocity() / kRuns;
  }
  // An acceleration is allowed for and does not happen: the filter is more careful than needed.
  EXPECT_LT(sum / kRuns, 6 + 3 * std::sqrt(12.0 / kRuns));
  EXPECT_GT(sum / kRuns, 3);
  EXPECT_LT((mean - velocity).head<3>().norm(), 0.02);
  EXPECT_LT((mean - velocity).tail<3>().norm(), 0.2);
}

TEST(MotionFilter, ComesToRestAgain) {
  Vector6d velocity = Vector6d::Zero();
  velocity[0] = 0.3;
  Measured measured(diagonal(0.001, 0.01), 5);
  MotionFilter filter(measured.of(kStart));
  for (int i = 1; i <= 90; ++i) {
    filter.predict(kFrame_s, true);
    filter.update(measured.of(at(velocity, std::min(i, 30) * kFrame_s)));
    if (i == 30) {
      EXPECT_TRUE(filter.moves());
    }
  }
  EXPECT_FALSE(filter.moves());
  EXPECT_LT((filter.pose().translation - at(velocity, 1).translation).norm(), 0.004);
}

TEST(MotionFilter, PredictsTheWayOnAndFadesWhileUnseen) {
  Vector6d velocity = Vector6d::Zero();
  velocity.head<3>() << 0.5, 0, 0;
  MotionFilter filter({kStart, diagonal(0.001, 0.01)});
  for (int i = 1; i <= 60; ++i) {
    filter.predict(kFrame_s, true);
    filter.update({at(velocity, i * kFrame_s), diagonal(0.001, 0.01)});
  }
  const Eigen::Vector3d before = filter.pose().translation;
  const double speed = filter.velocity().x();
  MotionFilter seen = filter;
  seen.predict(0.1, true);
  EXPECT_NEAR(seen.pose().translation.x() - before.x(), 0.1 * speed, 1e-9);
  EXPECT_NEAR(seen.velocity().x(), speed, 1e-12);
  const double variance = filter.covariance()(0, 0);
  for (int i = 0; i < 60; ++i) filter.predict(kFrame_s, false);
  // The sum of a geometric series: one step, and each next one by exp(-dt / 0.3 s) less.
  const double kept = std::exp(-kFrame_s / 0.3);
  const double way = speed * kFrame_s * (1 - std::pow(kept, 60)) / (1 - kept);
  EXPECT_NEAR(filter.pose().translation.x() - before.x(), way, 1e-9);
  EXPECT_GT(filter.covariance()(0, 0), 100 * variance);
}

}  // namespace
}  // namespace bpa::track
