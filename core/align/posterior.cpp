// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/posterior.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/align/moments.hpp"
#include "core/bingham/normalizer.hpp"

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// A choice of signs for the curvature directions so far.
struct Hypothesis {
  Matrix4d exponent;
  double log_mass = 0;

  explicit Hypothesis(const Matrix4d& c)
      : exponent(c), log_mass(bingham_log_normalizer(symmetric_eigen(c).values)) {}
};

// Each curvature direction doubles the hypotheses; the light ones are dropped as we go.
std::vector<Hypothesis> sign_hypotheses(const Correspondences& data, const Matrix4d& base,
                                        const CurvatureTerms& curvature,
                                        const PosteriorOptions& options) {
  std::vector<Hypothesis> hypotheses = {Hypothesis(base)};
  const double log_smallest = std::log(std::max(options.smallest_weight, 1e-300));
  curvature.for_each(data, [&](const CurvatureTerm& term) {
    const Matrix4d exponent = horn_matrix(term.attitude);
    std::vector<Hypothesis> next;
    for (const Hypothesis& h : hypotheses) {
      next.emplace_back(h.exponent + exponent);
      next.emplace_back(h.exponent - exponent);
    }
    std::ranges::stable_sort(next, std::greater(), &Hypothesis::log_mass);
    const auto most = std::clamp<std::ptrdiff_t>(options.max_hypotheses, 1, next.size());
    const auto light = [&](const Hypothesis& h) {
      return !(h.log_mass - next[0].log_mass > log_smallest);
    };
    hypotheses.assign(next.begin(), std::find_if(next.begin() + 1, next.begin() + most, light));
  });
  return hypotheses;
}

BinghamMixture to_mixture(const std::vector<Hypothesis>& hypotheses) {
  BinghamMixture mixture;
  double total = 0;
  for (const Hypothesis& h : hypotheses) {
    const double weight = std::exp(h.log_mass - hypotheses[0].log_mass);
    mixture.components.push_back({weight, Bingham::from_exponent(h.exponent)});
    total += weight;
  }
  for (BinghamMixture::Component& c : mixture.components) c.weight /= total;
  return mixture;
}

}  // namespace

Posterior posterior(const Correspondences& data, const PosteriorOptions& options) {
  Posterior result;
  result.map = bpa_mode(data);
  CurvatureTerms curvature;
  const Moments moments = accumulate(data, curvature);
  result.weight = moments.weight;
  result.model_centroid = moments.model_centroid;
  result.scene_centroid = moments.scene_centroid;
  if (data.curvature_sign_known || curvature.count() == 0) {
    result.orientation.components = {{1, Bingham::from_exponent(result.map.exponent)}};
    return result;
  }
  Matrix4d base = horn_matrix(moments.attitude);
  if (data.orientation_prior != nullptr) base += data.orientation_prior->exponent();
  result.orientation = to_mixture(sign_hypotheses(data, base, curvature, options));
  return result;
}

Pose Posterior::sample(RandomStream& random) const {
  Pose pose;
  pose.rotation = orientation.sample(random);
  if (!(weight > 0)) return pose;
  const double sigma = 1 / std::sqrt(weight);
  const double x = random.normal(), y = random.normal(), z = random.normal();
  pose.translation = scene_centroid + sigma * Vector3d(x, y, z) - pose.rotation * model_centroid;
  return pose;
}

double Posterior::log_density(const Pose& pose) const {
  double result = orientation.log_density(pose.rotation);
  if (weight > 0) {
    result += 1.5 * std::log(weight / (2 * M_PI)) -
              0.5 * weight * (pose * model_centroid - scene_centroid).squaredNorm();
  }
  return result;
}

Matrix6d Posterior::covariance() const {
  const Quaterniond mode = map.camera_from_object.rotation;
  const Matrix3d turn = rotation_covariance(Bingham::from_exponent(map.exponent));
  // t = ȳ + u - exp(ω) R x̄, so δt = u + (R x̄) x ω.
  const Matrix3d lever = cross_matrix(mode * model_centroid);
  Matrix6d result;
  result.bottomRightCorner<3, 3>() = turn;
  result.topRightCorner<3, 3>() = lever * turn;
  result.bottomLeftCorner<3, 3>() = (lever * turn).transpose();
  result.topLeftCorner<3, 3>() = lever * turn * lever.transpose();
  if (weight > 0) result.topLeftCorner<3, 3>() += Matrix3d::Identity() / weight;
  return result;
}

}  // namespace bpa::align
