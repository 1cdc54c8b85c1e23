// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/align/anisotropy.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/align/moments.hpp"
#include "core/bingham/eigen4.hpp"
#include "core/geometry/solve_symmetric.hpp"

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// One measured position, with the inverse of its true covariance.
struct PositionTerm {
  Vector3d model;
  Vector3d scene;
  Matrix3d precision;
};

PositionTerm make_term(const Vector3d& model, const Vector3d& scene, double variance,
                       const Matrix3d* covariance) {
  if (covariance != nullptr) return {model, scene, covariance->inverse()};
  return {model, scene, Matrix3d::Identity() / variance};
}

std::vector<PositionTerm> position_terms(const Correspondences& data,
                                         const Anisotropy& anisotropy) {
  std::vector<PositionTerm> terms;
  for (std::size_t i = 0; i < data.oriented.size(); ++i) {
    const OrientedPair& p = data.oriented[i];
    terms.push_back(make_term(p.model.point, p.scene.point, p.sigma * p.sigma,
                              anisotropy.oriented.empty() ? nullptr : &anisotropy.oriented[i]));
  }
  for (std::size_t i = 0; i < data.positions.size(); ++i) {
    const PositionPair& p = data.positions[i];
    terms.push_back(make_term(p.model, p.scene, p.sigma * p.sigma,
                              anisotropy.positions.empty() ? nullptr : &anisotropy.positions[i]));
  }
  if (data.position_prior != nullptr) {
    const PositionPrior& prior = *data.position_prior;
    terms.push_back(
        make_term(Vector3d::Zero(), prior.mean, prior.covariance.trace() / 3, &prior.covariance));
  }
  return terms;
}

// Given an orientation, the translation is Gaussian; this is it, and what is left of the likelihood
// when it is integrated out.
struct TranslationGiven {
  Vector3d mean = Vector3d::Zero();
  double log_likelihood = 0;
};

class PositionModel {
 public:
  explicit PositionModel(std::vector<PositionTerm> terms) : terms_(std::move(terms)) {
    for (const PositionTerm& t : terms_) precision_ += t.precision;
    if (!terms_.empty()) factor_.compute(precision_);
  }

  bool empty() const { return terms_.empty(); }

  TranslationGiven given(const Matrix3d& rotation) const {
    TranslationGiven result;
    if (empty()) return result;
    Vector3d information = Vector3d::Zero();
    double squares = 0;
    // Relative to a first estimate, so that the difference of squares below loses nothing.
    const Vector3d about = terms_[0].scene - rotation * terms_[0].model;
    for (const PositionTerm& t : terms_) {
      const Vector3d r = t.scene - rotation * t.model - about;
      const Vector3d weighted = t.precision * r;
      information += weighted;
      squares += r.dot(weighted);
    }
    const Vector3d offset = factor_.solve(information);
    result.mean = about + offset;
    result.log_likelihood = -0.5 * (squares - information.dot(offset));
    return result;
  }

  Vector3d draw(const Vector3d& mean, RandomStream& random) const {
    if (empty()) return mean;
    Vector3d z;
    for (int i = 0; i < 3; ++i) z[i] = random.normal();
    return mean + factor_.matrixU().solve(z);
  }

  const std::vector<PositionTerm>& terms() const { return terms_; }

 private:
  std::vector<PositionTerm> terms_;
  Matrix3d precision_ = Matrix3d::Zero();
  Eigen::LLT<Matrix3d> factor_;
};

// One pair's exponent at an orientation, as given and with the scene's curvature direction
// reversed.
struct OrientationTerm {
  double as_given;
  double reversed;
};

OrientationTerm orientation_term(const OrientedPair& pair, const Quaterniond& q) {
  const FeatureConcentration c = compose(pair.model, pair.scene);
  const Quaterniond e = pair.scene.orientation.conjugate() * q * pair.model.orientation;
  const double tilt = c.kappa * (e.y() * e.y() + e.z() * e.z());
  return {tilt + c.lambda3 * e.x() * e.x(), tilt + c.lambda3 * e.w() * e.w()};
}

// Log of the orientations' true likelihood: where a sign is open, the mean of both.
double log_orientation_likelihood(const Correspondences& data, const Quaterniond& q) {
  double sum = 0;
  for (const OrientedPair& pair : data.oriented) {
    const OrientationTerm term = orientation_term(pair, q);
    if (data.curvature_sign_known) {
      sum += term.as_given;
    } else {
      const double larger = std::max(term.as_given, term.reversed);
      const double smaller = std::min(term.as_given, term.reversed);
      sum += larger + std::log1p(std::exp(smaller - larger)) - M_LN2;
    }
  }
  if (data.orientation_prior != nullptr) sum += data.orientation_prior->log_ratio_to_mode(q);
  return sum;
}

// The exponent of all orientations (and the prior), with the signs that agree with q.
Matrix4d orientation_exponent(const Correspondences& data, const Quaterniond& q) {
  Matrix4d exponent = Matrix4d::Zero();
  for (const OrientedPair& pair : data.oriented) {
    const FeatureConcentration c = compose(pair.model, pair.scene);
    const OrientationTerm term = orientation_term(pair, q);
    const bool reverse = !data.curvature_sign_known && term.reversed > term.as_given;
    const Quaterniond scene =
        reverse ? reversed_curvature(pair.scene.orientation) : pair.scene.orientation;
    exponent += Bingham::about(scene, {c.lambda3, c.kappa, c.kappa})
                    .rotated_right(pair.model.orientation.conjugate())
                    .exponent();
  }
  if (data.orientation_prior != nullptr) exponent += data.orientation_prior->exponent();
  return exponent;
}

// Columns (0, axis i) ∘ q: twice the derivative of exp(ω) ∘ q by ω.
Eigen::Matrix<double, 4, 3> tangent_basis(const Quaterniond& q) {
  return right_product(q).rightCols<3>();
}

// Gradient and negative Hessian of the log posterior in (t, ω), R -> exp(ω) R. Positions by Gauss
// and Newton, orientations exactly.
struct Quadratic {
  Vector6d gradient = Vector6d::Zero();
  Matrix6d precision = Matrix6d::Zero();
};

Quadratic local_quadratic(const Correspondences& data, const PositionModel& positions,
                          const Pose& pose) {
  Quadratic result;
  const Matrix3d rotation = pose.matrix();
  for (const PositionTerm& t : positions.terms()) {
    const Vector3d turned = rotation * t.model;
    const Vector3d residual = t.scene - turned - pose.translation;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian.leftCols<3>().setIdentity();
    jacobian.rightCols<3>() = -cross_matrix(turned);
    result.gradient += jacobian.transpose() * (t.precision * residual);
    result.precision += jacobian.transpose() * t.precision * jacobian;
  }
  const Vector4d q = to_wxyz(pose.rotation);
  const Matrix4d c = orientation_exponent(data, pose.rotation);
  const Eigen::Matrix<double, 4, 3> tangent = tangent_basis(pose.rotation);
  result.gradient.tail<3>() += tangent.transpose() * (c * q);
  result.precision.bottomRightCorner<3, 3>() +=
      0.5 * (q.dot(c * q) * Matrix3d::Identity() - tangent.transpose() * c * tangent);
  return result;
}

double log_posterior(const Correspondences& data, const PositionModel& positions,
                     const Pose& pose) {
  double sum = log_orientation_likelihood(data, pose.rotation);
  for (const PositionTerm& t : positions.terms()) {
    const Vector3d r = pose * t.model - t.scene;
    sum -= 0.5 * r.dot(t.precision * r);
  }
  return sum;
}

// What nothing is known about: 1 m per axis of position, a uniform angle about each of rotation.
Vector6d vague_precision() {
  Vector6d p;
  p << 1, 1, 1, Vector3d::Constant(3 / (M_PI * M_PI));
  return p;
}

RefinedPose refine(const Correspondences& data, const PositionModel& positions, const Pose& start,
                   int max_iterations) {
  RefinedPose result;
  result.camera_from_object = start;
  double damping = 1e-9;
  double value = log_posterior(data, positions, start);
  for (; result.iterations < max_iterations && !result.converged; ++result.iterations) {
    const Quadratic local = local_quadratic(data, positions, result.camera_from_object);
    Matrix6d damped = local.precision;
    damped.diagonal() += damping * (local.precision.diagonal() + vague_precision());
    const Vector6d step = solve_symmetric(damped, local.gradient);
    Pose next = result.camera_from_object;
    next.translation += step.head<3>();
    next.rotation = (rotation_from_vector(step.tail<3>()) * next.rotation).normalized();
    const double next_value = log_posterior(data, positions, next);
    if (next_value >= value - 1e-12 * std::abs(value)) {
      result.camera_from_object = next;
      result.converged = step.dot(local.gradient) < 1e-12;
      value = next_value;
      damping = std::max(1e-9, damping / 10);
    } else {
      damping = std::max(1e-4, damping * 10);
      if (damping > 1e6) break;
    }
  }
  Matrix6d precision = local_quadratic(data, positions, result.camera_from_object).precision;
  precision.diagonal() += vague_precision();
  result.covariance = inverse_symmetric(precision);
  return result;
}

// The isotropic mixture and, for each of its components, a Bingham with the covariance of the true
// posterior's maximum nearby; half of the weight each.
BinghamMixture orientation_proposal(const Correspondences& data, const Posterior& isotropic,
                                    const PositionModel& positions) {
  BinghamMixture mixture;
  for (const BinghamMixture::Component& c : isotropic.orientation.components) {
    mixture.components.push_back({0.5 * c.weight, c.bingham});
    const Pose start{c.bingham.mode(), positions.given(c.bingham.mode().toRotationMatrix()).mean};
    const RefinedPose refined = refine(data, positions, start, 10);
    // exp(-½ ωᵀ S⁻¹ ω) with ω = 2 e.
    const Matrix3d precision = refined.covariance.bottomRightCorner<3, 3>().inverse();
    const auto tangent = tangent_basis(refined.camera_from_object.rotation);
    const Matrix4d exponent = -2 * tangent * precision * tangent.transpose();
    mixture.components.push_back({0.5 * c.weight, Bingham::from_exponent(exponent)});
  }
  return mixture;
}

// Turns log weights, kept in `weight`, into weights that sum to 1; and says what they are worth.
void normalize_log_weights(SampledPosterior& result) {
  double largest = -INFINITY, sum = 0;
  for (const WeightedPose& s : result.samples) largest = std::max(largest, s.weight);
  for (WeightedPose& s : result.samples) sum += (s.weight = std::exp(s.weight - largest));
  double share = 0, squares = 0;
  for (WeightedPose& s : result.samples) {
    s.weight /= sum;
    share += s.weight;
    squares += s.weight * s.weight;
  }
  result.effective_sample_size = squares > 0 ? share * share / squares : 0;
}

}  // namespace

RefinedPose refine(const Correspondences& data, const Anisotropy& anisotropy, const Pose& start,
                   int max_iterations) {
  return refine(data, PositionModel(position_terms(data, anisotropy)), start, max_iterations);
}

SampledPosterior sample_posterior(const Correspondences& data, const Anisotropy& anisotropy,
                                  int count, RandomStream& random,
                                  const PosteriorOptions& options) {
  const Posterior isotropic = posterior(data, options);
  const PositionModel positions(position_terms(data, anisotropy));
  const bool exact =
      anisotropy.oriented.empty() && anisotropy.positions.empty() && data.position_prior == nullptr;
  const BinghamMixture proposal =
      exact ? isotropic.orientation : orientation_proposal(data, isotropic, positions);
  SampledPosterior result;
  result.samples.resize(std::max(0, count));
  for (WeightedPose& s : result.samples) {
    Pose& pose = s.camera_from_object;
    pose.rotation = proposal.sample(random);
    const TranslationGiven t = positions.given(pose.matrix());
    pose.translation = positions.draw(t.mean, random);
    s.weight = t.log_likelihood + log_orientation_likelihood(data, pose.rotation) -
               proposal.log_density(pose.rotation);
  }
  normalize_log_weights(result);
  return result;
}

}  // namespace bpa::align
