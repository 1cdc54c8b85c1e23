// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <string>

#include "server/convert/frames.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;

OrientationUncertainty orientation_from(const msgs::Bingham& message) {
  OrientationUncertainty orientation;
  orientation.axes = Eigen::Matrix<double, 4, 3>::Map(message.axes.data());
  orientation.concentrations = Eigen::Vector3d::Map(message.concentrations.data());
  return orientation;
}

/// The exponent of the density at q, 0 at its most probable values.
double exponent_at(const OrientationUncertainty& orientation, const Eigen::Vector4d& q) {
  return orientation.concentrations.dot((orientation.axes.transpose() * q).cwiseAbs2());
}

PosePrior prior_from(const msgs::PosePrior& message) {
  PosePrior prior;
  prior.model = message.model;
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const RowMajor covariance = RowMajor::Map(message.position_covariance.data());
  if ((covariance.array() != 0).any()) {
    const auto& p = message.pose.position;
    prior.position = PositionPrior{{p.x, p.y, p.z}, covariance};
  }
  prior.orientation = orientation_from(message.orientation);
  if (message.weight != 0) prior.weight = message.weight;
  return prior;
}

}  // namespace

Result<std::vector<PosePrior>> priors_from_messages(const std::vector<msgs::PosePrior>& messages) {
  constexpr double kOffMode = -0.5;  // of the exponent: one standard deviation
  std::vector<PosePrior> priors;
  for (const msgs::PosePrior& message : messages) {
    PosePrior prior = prior_from(message);
    const auto& q = message.pose.orientation;
    // Not for numbers that the detector will refuse.
    if (prior.orientation.concentrations.maxCoeff() <= 0 &&
        exponent_at(prior.orientation, {q.w, q.x, q.y, q.z}) < kOffMode) {
      return invalid_argument(
          "priors[" + std::to_string(priors.size()) +
          "].pose.orientation is not the most probable one of its orientation's "
          "distribution; it must be (axes are in the order w, x, y, z)");
    }
    priors.push_back(std::move(prior));
  }
  return priors;
}

}  // namespace bpa::server
