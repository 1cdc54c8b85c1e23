// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace bpa {

/// A rigid transform. Named by both its frames, a_from_b takes points in b to points in a:
/// x_in_a = rotation * x_in_b + translation, and a_from_c = a_from_b * b_from_c. Metres.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< Unit length.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  Pose operator*(const Pose& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Pose inverse() const {
    const Eigen::Quaterniond conjugate = rotation.conjugate();
    return {conjugate, -(conjugate * translation)};
  }
  Eigen::Matrix3d matrix() const { return rotation.toRotationMatrix(); }

  static Pose from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation);
  /// The upper three rows of a 4x4 homogeneous matrix; its rotation part is made orthonormal.
  static Pose from_matrix(const Eigen::Matrix4d& matrix);
};

/// The quaternion as (w, x, y, z), the order of the paper's (q1, q2, q3, q4).
inline Eigen::Vector4d to_wxyz(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }
/// The quaternion of a (w, x, y, z) vector, normalised.
inline Eigen::Quaterniond from_wxyz(const Eigen::Vector4d& v) {
  return Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized();
}

/// The angle of the rotation between two orientations, in [0, π].
double rotation_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// The rotation by |v| radians about v; identity for zero.
Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& v);
/// The rotation vector (axis times angle in [0, π]) of a unit quaternion.
Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& q);

/// True when rotation and translation are finite and the quaternion has unit length within 1e-6.
bool is_valid(const Pose& pose);

/// A rigid transform in single precision, as a matrix, for inner loops.
struct FastPose {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();  ///< Metres.

  Eigen::Vector3f operator*(const Eigen::Vector3f& point) const {
    return rotation * point + translation;
  }
};

inline FastPose to_fast(const Pose& pose) {
  return {pose.matrix().cast<float>(), pose.translation.cast<float>()};
}
inline Pose to_pose(const FastPose& pose) {
  return {Eigen::Quaterniond(pose.rotation.cast<double>()).normalized(),
          pose.translation.cast<double>()};
}

/// A Gaussian of a position: where an object's origin is in the camera frame.
struct PositionPrior {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();            ///< Metres.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< m².
};

}  // namespace bpa
