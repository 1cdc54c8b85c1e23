// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/moments.hpp"

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

double inverse_square(double sigma) { return 1 / (sigma * sigma); }

// The variance of the isotropic Gaussian that stands for the prior: the mean of its covariance's
// eigenvalues. What that leaves out is in posterior.hpp.
double isotropic_variance(const PositionPrior& prior) { return prior.covariance.trace() / 3; }

// The first column of the rotation matrix: the normal.
Vector3d normal_of(const Quaterniond& q) {
  return {1 - 2 * (q.y() * q.y() + q.z() * q.z()), 2 * (q.x() * q.y() + q.w() * q.z()),
          2 * (q.x() * q.z() - q.w() * q.y())};
}

// Calls visit(model, scene, weight, pair) for everything that has a position; `pair` is null where
// it has no orientation.
void for_each_position(const Correspondences& data, const auto& visit) {
  for (const OrientedPair& pair : data.oriented) {
    visit(pair.model.point, pair.scene.point, inverse_square(pair.sigma), &pair);
  }
  const OrientedPair* const none = nullptr;
  for (const PositionPair& pair : data.positions) {
    visit(pair.model, pair.scene, inverse_square(pair.sigma), none);
  }
  if (data.position_prior != nullptr) {  // A pair of the object's origin.
    const PositionPrior& prior = *data.position_prior;
    visit(Vector3d::Zero(), prior.mean, 1 / isotropic_variance(prior), none);
  }
}

// Weighted centroids of everything that has a position.
Moments centroids(const Correspondences& data) {
  Moments m;
  for_each_position(data,
                    [&m](const Vector3d& model, const Vector3d& scene, double w, const void*) {
                      m.weight += w;
                      m.model_centroid += w * model;
                      m.scene_centroid += w * scene;
                    });
  if (m.weight > 0) {
    m.model_centroid /= m.weight;
    m.scene_centroid /= m.weight;
  }
  return m;
}

void add_position(const Vector3d& model, const Vector3d& scene, double weight, Moments& m) {
  const Vector3d x = model - m.model_centroid, y = scene - m.scene_centroid;
  m.attitude += (weight * x) * y.transpose();
  m.constant -= 0.5 * weight * (x.squaredNorm() + y.squaredNorm());
}

void add_orientation(const OrientedPair& pair, Moments& m, CurvatureTerms& curvature) {
  // κ (ey² + ez²) = κ/2 (1 - cos n) and λ3 ex² = λ3/4 (1 + cos n - cos p - cos p'), where cos n is
  // the cosine between the two normals, turned by the pose.
  if (!(pair.model.kappa * pair.scene.kappa > 0)) return;
  const FeatureConcentration c = compose(pair.model, pair.scene);
  const double weight = 0.25 * c.lambda3 - 0.5 * c.kappa;
  const Vector3d model_normal = normal_of(pair.model.orientation);
  const Vector3d scene_normal = normal_of(pair.scene.orientation);
  const Matrix3d normals = model_normal * scene_normal.transpose();
  m.attitude += weight * normals;
  m.constant += 0.5 * c.kappa + 0.25 * c.lambda3;
  if (!(c.lambda3 < 0)) return;
  // n nᵀ + p pᵀ + p' p'ᵀ of model and scene is the product of their rotation matrices.
  CurvatureTerm term;
  const Quaterniond relative = pair.model.orientation * pair.scene.orientation.conjugate();
  term.attitude = (-0.25 * c.lambda3) * (relative.toRotationMatrix() - normals);
  term.largest = -0.5 * c.lambda3;
  curvature.add(term);
}

}  // namespace

void CurvatureTerms::add(const CurvatureTerm& term) {
  if (count_ < kCapacity) kept_[count_] = term;
  ++count_;
  total_ += term.largest;
  if (term.largest > strongest_.largest) strongest_ = term;
}

Moments accumulate(const Correspondences& data, CurvatureTerms& curvature) {
  Moments m = centroids(data);
  for_each_position(data, [&](const Vector3d& model, const Vector3d& scene, double weight,
                              const OrientedPair* pair) {
    add_position(model, scene, weight, m);
    if (pair != nullptr) add_orientation(*pair, m, curvature);
  });
  return m;
}

Moments accumulate_positions(const Correspondences& data) {
  Correspondences bare = data;
  bare.position_prior = nullptr;
  Moments m = centroids(bare);
  for_each_position(bare, [&m](const Vector3d& model, const Vector3d& scene, double weight,
                               const void*) { add_position(model, scene, weight, m); });
  return m;
}

CurvatureTerm curvature_term(const OrientedPair& pair) {
  CurvatureTerms terms;
  Moments unused;
  add_orientation(pair, unused, terms);
  return terms.strongest();
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Matrix4d horn_matrix(const Matrix3d& s) {
  Matrix4d n;
  n(0, 0) = s(0, 0) + s(1, 1) + s(2, 2);
  n(1, 1) = s(0, 0) - s(1, 1) - s(2, 2);
  n(2, 2) = s(1, 1) - s(0, 0) - s(2, 2);
  n(3, 3) = s(2, 2) - s(0, 0) - s(1, 1);
  n(0, 1) = n(1, 0) = s(1, 2) - s(2, 1);
  n(0, 2) = n(2, 0) = s(2, 0) - s(0, 2);
  n(0, 3) = n(3, 0) = s(0, 1) - s(1, 0);
  n(1, 2) = n(2, 1) = s(0, 1) + s(1, 0);
  n(1, 3) = n(3, 1) = s(0, 2) + s(2, 0);
  n(2, 3) = n(3, 2) = s(1, 2) + s(2, 1);
  return n;
}

}  // namespace bpa::align
