// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <cmath>

#include "core/detect/single_object.hpp"

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

}  // namespace

Placement to_placement(const Candidate& candidate) {
  Placement out;
  out.model_number = candidate.model->number;
  out.model = candidate.model->name;
  out.camera_from_object = candidate.pose();
  out.covariance = pose_covariance(candidate.refinement);
  out.orientation = orientation_uncertainty(out.camera_from_object.rotation,
                                            out.covariance.bottomRightCorner<3, 3>());
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
                    {"color", c.color},
                    {"rivals", c.rivals}};
  std::erase_if(out.components,
                [](const ScoreComponent& known) { return std::isnan(known.value); });
  if (candidate.prior != 0) out.components.push_back({"prior", candidate.prior});
  return out;
}

}  // namespace bpa
