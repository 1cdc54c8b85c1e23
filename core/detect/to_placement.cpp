// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/detect/candidate.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
namespace {

Eigen::Matrix<double, 6, 6> pose_covariance(const Refinement& refinement) {
  Eigen::Matrix<double, 6, 6> information = refinement.information / tolerance::kCorrelatedPoints;
  constexpr double kPositionSigma = tolerance::placed_m(8),
                   kAngleSigma = 0.5;  // m, rad: where nothing is known
  const double position = 1 / (kPositionSigma * kPositionSigma);
  const double angle = 1 / (kAngleSigma * kAngleSigma);
  information.diagonal().head<3>().array() += position;
  information.diagonal().tail<3>().array() += angle;
  const Eigen::Matrix<double, 6, 6> inverse = inverse_symmetric(information);
  return 0.5 * (inverse + inverse.transpose());
}

}  // namespace

Placement to_placement(const Candidate& candidate) {
  Placement out;
  out.model_number = candidate.model->number;
  out.model = candidate.model->name;
  out.frame_from_object = candidate.pose();
  out.covariance = pose_covariance(candidate.refinement);
  out.orientation = orientation_uncertainty(out.frame_from_object.rotation,
                                            out.covariance.bottomRightCorner<3, 3>());
  out.score = candidate.score;
  out.probability = candidate.probability;
  out.visible_fraction = candidate.values[score::component("visibility")];
  for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
    if (std::isnan(candidate.values[i])) continue;
    out.components.push_back({std::string(score::kScoreComponents[i].name), candidate.values[i]});
  }
  if (candidate.prior != 0) out.components.push_back({"prior", candidate.prior});
  return out;
}

}  // namespace bpa::detect
