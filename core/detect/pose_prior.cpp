// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/pose_prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/model/model_index.hpp"

namespace bpa::detect {
namespace {

constexpr double kQuaternionArea = 2 * M_PI * M_PI;  // of S3, which densities refer to

Status broken(const std::string& name, const std::string& field, double value,
              const std::string& rule) {
  return invalid_argument(name, ".", field, " is ", value, "; it must be ", rule);
}

Status check_finite(const std::string& name, const std::string& field, const auto& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values(i))) return broken(name, field, values(i), "finite");
  }
  return {};
}

Status check_position(const PositionPrior& position, const std::string& name) {
  if (Status s = check_finite(name, "position mean", position.mean); !s.ok()) return s;
  const Eigen::Matrix3d& c = position.covariance;
  if (Status s = check_finite(name, "position covariance", c); !s.ok()) return s;
  const bool symmetric = (c - c.transpose()).norm() <= 1e-6 * c.norm();
  if (!symmetric || c.llt().info() != Eigen::Success) {
    return invalid_argument(
        name, ".position covariance is not symmetric and positive definite; it must be");
  }
  return {};
}

Status check_orientation(const OrientationUncertainty& orientation, const std::string& name) {
  const Eigen::Vector3d& concentrations = orientation.concentrations;
  Status status = check_finite(name, "orientation concentration", concentrations);
  if (!status.ok() || concentrations.isZero(0)) return status;
  if (concentrations.maxCoeff() > 0) {
    return broken(name, "orientation concentration", concentrations.maxCoeff(), "0 or less");
  }
  if (Status s = check_finite(name, "orientation axes", orientation.axes); !s.ok()) return s;
  const Eigen::Matrix3d products = orientation.axes.transpose() * orientation.axes;
  if ((products - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-3) {
    return invalid_argument(name,
                            ".orientation axes are not three unit quaternions at right angles to "
                            "one another; they must be");
  }
  return {};
}

// A Gaussian of small turns with standard deviation σ is a Bingham of concentration -2 / σ²; what
// two such errors make together has the sum of their variances.
Bingham widen(const Bingham& orientation) {
  constexpr double kVariance = kPlacementSigma_rad * kPlacementSigma_rad;
  const Eigen::Vector3d lambda = orientation.concentrations().tail<3>();
  const Eigen::Vector3d widened = lambda.array() / (1 - 0.5 * kVariance * lambda.array());
  return Bingham::from_axes(widened, orientation.axes().rightCols<3>());
}

// Turns about an axis are sampled finely enough for a mean over them of what is no narrower than
// kPlacementSigma_rad.
constexpr int kTurns = 64;

}  // namespace

Status validate(const PosePrior& prior, const std::string& name) {
  if (!(prior.weight > 0 && prior.weight <= 1)) {
    return broken(name, "weight", prior.weight, "above 0 and at most 1");
  }
  if (prior.position) {
    if (Status s = check_position(*prior.position, name); !s.ok()) return s;
  }
  return check_orientation(prior.orientation, name);
}

Bingham orientation_of(const PosePrior& prior) {
  if (prior.orientation.concentrations.isZero(0)) return {};
  return Bingham::from_axes(prior.orientation.concentrations, prior.orientation.axes);
}

PosePrior transformed(const Pose& a_from_b, const PosePrior& prior) {
  PosePrior out = prior;
  if (prior.position) {
    const Eigen::Matrix3d turn = a_from_b.matrix();
    out.position->mean = a_from_b * prior.position->mean;
    out.position->covariance = turn * prior.position->covariance * turn.transpose();
  }
  out.orientation.axes = left_product(a_from_b.rotation) * prior.orientation.axes;
  return out;
}

ModelPriors::ModelPriors(std::span<const PosePrior> priors, const ObjectModel& model)
    : model_(model) {
  for (const PosePrior& prior : priors) {
    if (prior.model != model.name) continue;
    priors_.push_back(prepare(prior));
    if (model.symmetry.continuous.size() < 2) continue;
    priors_.back().widened = {};  // the orientation of a sphere says nothing
    priors_.back().log_orientation_peak = 0;
  }
  if (!priors_.empty()) same_ = sampled_elements(model.symmetry, kTurns);
}

ModelPriors::Prior ModelPriors::prepare(const PosePrior& prior) {
  Prior out;
  out.weight = prior.weight;
  out.position = prior.position;
  out.orientation = orientation_of(prior);
  out.widened = widen(out.orientation);
  out.log_orientation_peak = std::log(kQuaternionArea) - out.widened.log_normalizer();
  if (!prior.position) return out;
  constexpr double kVariance = kPlacementSigma_m * kPlacementSigma_m;
  const Eigen::Matrix3d covariance =
      prior.position->covariance + kVariance * Eigen::Matrix3d::Identity();
  out.information = covariance.inverse();
  out.log_position_peak = std::log(kBackgroundVolume) - 1.5 * std::log(2 * M_PI) -
                          0.5 * std::log(covariance.determinant());
  return out;
}

double ModelPriors::Prior::ratio(const Pose& pose) const {
  double log_ratio = log_orientation_peak + widened.log_ratio_to_mode(pose.rotation);
  if (position) {
    const Eigen::Vector3d d = pose.translation - position->mean;
    log_ratio += log_position_peak - 0.5 * d.dot(information * d);
  }
  return std::exp(log_ratio);
}

double ModelPriors::mean_ratio(const Prior& prior, const Pose& pose) const {
  double sum = 0;
  for (const Pose& element : same_) sum += prior.ratio(pose * element);
  return sum / static_cast<double>(same_.size());
}

double ModelPriors::evidence(const Pose& camera_from_object) const {
  if (priors_.empty()) return 0;
  double sum = 0;
  for (const Prior& prior : priors_) {
    sum += (1 - prior.weight) + prior.weight * mean_ratio(prior, camera_from_object);
  }
  return std::clamp(std::log(sum / static_cast<double>(priors_.size())), -kMostPriorEvidence,
                    kMostPriorEvidence);
}

std::vector<Pose> ModelPriors::draw(const PointCloud& surface, int count,
                                    RandomStream& random) const {
  const PointCloud& points = model_.index->coarse;
  const auto any_of = [&random](const PointCloud& cloud) {
    return random.index(static_cast<int>(cloud.size()));
  };
  std::vector<Pose> out;
  for (const Prior& prior : priors_) {
    if (!prior.position && (surface.size() == 0 || points.size() == 0)) continue;
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    if (prior.position) root = prior.position->covariance.llt().matrixL();
    for (int k = 0; k < count; ++k) {
      Pose pose{prior.orientation.sample(random), Eigen::Vector3d::Zero()};
      if (prior.position) {
        const double z = random.normal();
        const double y = random.normal();
        const double x = random.normal();
        pose.translation = prior.position->mean + root * Eigen::Vector3d(x, y, z);
      } else {
        // The model point whose normal agrees best, of a few.
        constexpr int kTries = 16;
        const int on = any_of(surface);
        int best = 0;
        double agreement = -2;
        for (int t = 0; t < kTries; ++t) {
          const int at = any_of(points);
          const double cosine = (pose.rotation * points.normals[at].cast<double>())
                                    .dot(surface.normals[on].cast<double>());
          if (cosine > agreement) {
            agreement = cosine;
            best = at;
          }
        }
        pose.translation =
            surface.points[on].cast<double>() - pose.rotation * points.points[best].cast<double>();
      }
      out.push_back(pose);
    }
  }
  return out;
}

}  // namespace bpa::detect
