// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include <bpa/core/detect/single_object.hpp>

namespace bpa {
namespace {

// Depth errors of neighbouring pixels go together, so that the correspondences count for fewer.
constexpr double kCorrelatedPoints = 12;

Eigen::Matrix<double, 6, 6> pose_covariance(const Refinement& refinement) {
  Eigen::Matrix<double, 6, 6> information = refinement.information / kCorrelatedPoints;
  const double position = 1 / (0.02 * 0.02);
  const double angle = 1 / (0.5 * 0.5);
  information.diagonal().head<3>().array() += position;
  information.diagonal().tail<3>().array() += angle;
  const Eigen::Matrix<double, 6, 6> inverse = information.inverse();
  return 0.5 * (inverse + inverse.transpose());
}

// A small rotation by d about the camera's axes has the quaternion (1, d / 2), so that a Gaussian
// of covariance C in d is a Bingham with the exponent -2 v^T C^-1 v in v = d / 2.
OrientationUncertainty orientation_uncertainty(const Pose& pose,
                                               const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  OrientationUncertainty out;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = solver.eigenvectors().col(k);
    const Eigen::Quaterniond turned =
        Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()) * pose.rotation;
    out.axes.col(k) = to_wxyz(turned);
    out.concentrations[k] = -2 / solver.eigenvalues()[k];
  }
  return out;
}

}  // namespace

Placement to_placement(const Candidate& candidate) {
  Placement out;
  out.model_number = candidate.model->number;
  out.model = candidate.model->name;
  out.camera_from_object = candidate.pose();
  out.covariance = pose_covariance(candidate.refinement);
  out.orientation =
      orientation_uncertainty(out.camera_from_object, out.covariance.bottomRightCorner<3, 3>());
  out.score = candidate.score;
  out.probability = candidate.probability;
  const ScoreComponents& c = candidate.components;
  out.visible_fraction = c.visibility;
  out.components = {{"range", c.range},
                    {"normal", c.normal},
                    {"visibility", c.visibility},
                    {"edge", c.edge},
                    {"edge_visibility", c.edge_visibility},
                    {"edge_support", c.edge_support},
                    {"shape", c.shape},
                    {"free_space", c.free_space},
                    {"agreeing", c.agreeing},
                    {"explained_pixels", c.explained_pixels},
                    {"expected_pixels", c.expected_pixels},
                    {"explained_area", c.explained_area},
                    {"relative_area", c.relative_area},
                    {"unknown", c.unknown},
                    {"background", c.background},
                    {"edge_likelihood", c.edge_likelihood},
                    {"occlusion_edge", c.occlusion_edge},
                    {"random_walk", c.random_walk},
                    {"segment", c.segment},
                    {"segment_affinity", c.segment_affinity},
                    {"fpfh", c.fpfh},
                    {"color", c.color}};
  std::erase_if(out.components,
                [](const ScoreComponent& known) { return std::isnan(known.value); });
  return out;
}

}  // namespace bpa
