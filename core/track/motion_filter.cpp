// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"

namespace bpa::track {
namespace {

// Chosen by hand: what hands and robot arms do to objects.
constexpr double kAcceleration = 3;         // m/s², standard deviation
constexpr double kAngularAcceleration = 6;  // rad/s², the same
constexpr double kStartSpeed = 0.4;         // m/s: of what begins to move
constexpr double kStartTurn = 1.2;          // rad/s: the same
// A resting object drifts, as the alignment does when the view of it changes.
constexpr double kDrift = 0.0005;        // m in a second
constexpr double kAngularDrift = 0.004;  // rad in a second
constexpr double kFade_s = 0.3;          // in which an unseen object loses its velocity

// Of the squared Mahalanobis distance with 6 degrees of freedom (chi-square).
constexpr double kNinetyFive = 12.59, kThousandth = 22.46;
constexpr int kFarInARow = 2;    // such measurements: it moves
constexpr int kSlowInARow = 10;  // velocities: it rests

constexpr double kWhite = 0.5;  // of a measurement's covariance

void add_diagonal(Matrix12d& matrix, int first, double position, double angle) {
  for (int i = 0; i < 3; ++i) {
    matrix(first + i, first + i) += position;
    matrix(first + 3 + i, first + 3 + i) += angle;
  }
}

// White acceleration over a time: its part of position, of both, of velocity.
void add_acceleration(Matrix12d& matrix, double t) {
  const double at = t * t / 2;
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? kAcceleration : kAngularAcceleration;
    const double variance = sigma * sigma;
    matrix(i, i) += variance * at * at;
    matrix(i, 6 + i) += variance * at * t;
    matrix(6 + i, i) += variance * at * t;
    matrix(6 + i, 6 + i) += variance * t * t;
  }
}

// Squared Mahalanobis distance, 6 degrees of freedom.
double squared(const Vector6d& apart, const Matrix6d& covariance) {
  return apart.dot(Vector6d(solve_symmetric(covariance, apart)));
}

}  // namespace

Vector6d difference(const Pose& to, const Pose& from) {
  Vector6d out;
  out << to.translation - from.translation,
      vector_from_rotation(to.rotation * from.rotation.conjugate());
  return out;
}

Pose moved(const Pose& from, const Vector6d& by) {
  return {(rotation_from_vector(by.tail<3>()) * from.rotation).normalized(),
          from.translation + by.head<3>()};
}

MotionFilter::MotionFilter(const UncertainPose& first) : pose_(first.pose) {
  covariance_.topLeftCorner<6, 6>() = kWhite * first.covariance;
  common_ = (1 - kWhite) * first.covariance;
}

void MotionFilter::begin_to_move() {
  moves_ = true;
  far_ = slow_ = 0;
  add_diagonal(covariance_, 6, kStartSpeed * kStartSpeed, kStartTurn * kStartTurn);
}

void MotionFilter::predict(double seconds, bool seen) {
  if (!moves_) {
    add_diagonal(covariance_, 0, kDrift * kDrift * seconds,
                 kAngularDrift * kAngularDrift * seconds);
    return;
  }
  pose_ = moved(pose_, velocity_ * seconds);
  Matrix12d step = Matrix12d::Identity();
  step.block<3, 3>(3, 3) = rotation_from_vector(velocity_.tail<3>() * seconds).toRotationMatrix();
  step.topRightCorner<6, 6>() = seconds * Matrix6d::Identity();
  const double kept = seen ? 1 : std::exp(-seconds / kFade_s);
  step.bottomRightCorner<6, 6>() *= kept;
  velocity_ *= kept;
  covariance_ = step * covariance_ * step.transpose();
  add_acceleration(covariance_, seconds);
}

void MotionFilter::update(const UncertainPose& measured) {
  const Matrix6d white = kWhite * measured.covariance;
  common_ = (1 - kWhite) * measured.covariance;
  const Vector6d apart = difference(measured.pose, pose_);
  if (!moves_) {
    const bool far = squared(apart, covariance_.topLeftCorner<6, 6>() + white) > kThousandth;
    far_ = far ? far_ + 1 : 0;
    if (far_ >= kFarInARow) begin_to_move();
  }
  const Matrix6d innovation = inverse_symmetric(covariance_.topLeftCorner<6, 6>() + white);
  const Eigen::Matrix<double, 12, 6> gain = covariance_.leftCols<6>() * innovation;
  const Eigen::Matrix<double, 12, 1> step = gain * apart;
  pose_ = moved(pose_, step.head<6>());
  if (moves_) velocity_ += step.tail<6>();
  // Joseph's form stays positive definite.
  Matrix12d rest = Matrix12d::Identity();
  rest.leftCols<6>() -= gain;
  covariance_ = rest * covariance_ * rest.transpose() + gain * white * gain.transpose();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  if (moves_) rest_if_slow(white);
}

void MotionFilter::rest_if_slow(const Matrix6d& white) {
  if (squared(velocity_, covariance_.bottomRightCorner<6, 6>()) >= kNinetyFive) {
    slow_ = 0;
    return;
  }
  if (slow_++ == 0) anchor_ = pose_;
  const Matrix6d sum = covariance_.topLeftCorner<6, 6>() + white;
  if (squared(difference(pose_, anchor_), sum) > kNinetyFive) slow_ = 0;
  if (slow_ < kSlowInARow) return;
  moves_ = false;
  far_ = slow_ = 0;
  velocity_.setZero();
  covariance_.bottomRows<6>().setZero();
  covariance_.rightCols<6>().setZero();
}

}  // namespace bpa::track
