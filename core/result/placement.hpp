// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"

namespace bpa {

/// One named part of a placement's score, as an average log-likelihood (larger is better).
struct ScoreComponent {
  std::string name;
  double value = 0;
};

/// Another pose that explains the view, or what a track has seen, nearly as well.
struct PoseAlternative {
  Pose frame_from_object;  ///< In the frame of the placement or track, metres.
  double weight = 0;       ///< In (0, 1]; with its own weight, all alternatives' sum to 1.
};

/// Uncertainty of an orientation as a Bingham distribution (paper, appendix): density proportional
/// to exp(sum_i concentrations[i] (axes.col(i) . q)^2) over unit quaternions q = (w, x, y, z).
struct OrientationUncertainty {
  Eigen::Matrix<double, 4, 3> axes = Eigen::Matrix<double, 4, 3>::Zero();
  Eigen::Vector3d concentrations = Eigen::Vector3d::Zero();  ///< Not positive; 0 is uniform.
};

/// The uncertainty of an orientation with small Gaussian errors. `covariance` is of rotation
/// vectors about the camera's axes, rad²; positive definite.
OrientationUncertainty orientation_uncertainty(const Eigen::Quaterniond& rotation,
                                               const Eigen::Matrix3d& covariance);

/// One object at one pose, in the frame that SceneInterpretations::frame_id names: the optical
/// frame of the camera, or the fixed frame of several views (ViewsResult).
struct Placement {
  int model_number = 0;    ///< The model's number in its library.
  std::string model;       ///< The model's name.
  Pose frame_from_object;  ///< Metres.
  /// Covariance of (x, y, z, rotation about x, y, z), metres and radians. The axes are the
  /// frame's (order and meaning of geometry_msgs/PoseWithCovariance).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  OrientationUncertainty orientation;
  double score = 0;        ///< Log odds from the components; larger is better.
  double probability = 0;  ///< That the pose is within 2.5 cm and π/16 of the truth; in [0, 1].
  /// That the object is there, at this pose or at an alternative; in [0, 1].
  double presence = 0;
  /// Of the model surface that faces the camera, in [0, 1]. What is outside the image is not
  /// visible.
  double visible_fraction = 0;
  std::vector<ScoreComponent> components;     ///< What the score is made of.
  std::vector<PoseAlternative> alternatives;  ///< Empty: the view leaves no other pose.
};

/// The weight of the placement's own pose beside its alternatives' (PoseAlternative::weight).
double own_weight(const Placement& placement);

/// Whether no pose of the object has half of the weight.
bool pose_is_open(const Placement& placement);

/// The placement in frame a, from one in frame b: poses, covariance and orientation. To the last
/// bit the same where a_from_b is the identity.
Placement transformed(const Pose& a_from_b, const Placement& placement);

}  // namespace bpa
