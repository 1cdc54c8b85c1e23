// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose.hpp"

namespace bpa::track {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// A pose with the covariance of (x, y, z, rotation about x, y, z), metres and radians. All about
/// the axes of one frame.
struct UncertainPose {
  Pose pose;
  Matrix6d covariance = Matrix6d::Identity();
};

/// What turns `from` into `to`: (translation of the origin, rotation vector about the frame's
/// axes).
Vector6d difference(const Pose& to, const Pose& from);

/// `from` moved by such a difference.
Pose moved(const Pose& from, const Vector6d& by);

/// An extended Kalman filter of a pose on SE(3) with constant velocity. The error of the rotation
/// is on the side of the frame's axes (right-invariant; Barrau and Bonnabel, "The Invariant
/// Extended Kalman Filter as a Stable Observer", IEEE TAC 2017). It has two motions: an object
/// stands still until it is measured elsewhere, and moves until its velocity is lost in noise.
class MotionFilter {
 public:
  explicit MotionFilter(const UncertainPose& first);

  /// Moves to `seconds` later. `seen`: in the frame before; a velocity fades while it is not.
  void predict(double seconds, bool seen);

  /// Takes a measurement. Half of its covariance counts as white. The rest is what a view has wrong
  /// in every frame (model, calibration), which no average removes.
  void update(const UncertainPose& measured);

  /// Takes another of several likely poses. Velocity and covariance stay.
  void jump_to(const Pose& pose) { pose_ = pose; }
  const Pose& pose() const { return pose_; }
  Eigen::Vector3d velocity() const { return velocity_.head<3>(); }          ///< Of the origin, m/s.
  Eigen::Vector3d angular_velocity() const { return velocity_.tail<3>(); }  ///< rad/s.
  bool moves() const { return moves_; }
  /// Of the pose: the filter's, and the part of the measurements' that does not average out.
  Matrix6d covariance() const { return covariance_.topLeftCorner<6, 6>() + common_; }

 private:
  void begin_to_move();
  void rest_if_slow(const Matrix6d& white);

  Pose pose_;
  Vector6d velocity_ = Vector6d::Zero();
  Matrix12d covariance_ = Matrix12d::Zero();  ///< Of pose and velocity, without `common_`.
  Matrix6d common_ = Matrix6d::Zero();        ///< What all measurements have wrong alike.
  bool moves_ = false;
  int far_ = 0;   ///< Measurements in a row that a resting object would hardly give.
  int slow_ = 0;  ///< The same of velocities lost in noise.
  Pose anchor_;   ///< Where the velocity was first lost in noise.
};

}  // namespace bpa::track
