// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <bpa/core/align/moments.hpp>

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

double inverse_square(double sigma) { return 1 / (sigma * sigma); }

// The variance of the isotropic Gaussian that stands for the prior: the mean of its covariance's
// eigenvalues. What that leaves out is in anisotropy.hpp.
double isotropic_variance(const PositionPrior& prior) { return prior.covariance.trace() / 3; }

// First column of the rotation matrix.
Vector3d axis_x(const Quaterniond& q) {
  return {1 - 2 * (q.y() * q.y() + q.z() * q.z()), 2 * (q.x() * q.y() + q.w() * q.z()),
          2 * (q.x() * q.z() - q.w() * q.y())};
}

}  // namespace

Moments accumulate(const Correspondences& data) {
  Moments m;
  for (const OrientedPair& pair : data.oriented) {
    const double w = inverse_square(pair.sigma);
    m.weight += w;
    m.model_centroid += w * pair.model.point;
    m.scene_centroid += w * pair.scene.point;
  }
  for (const PositionPair& pair : data.positions) {
    const double w = inverse_square(pair.sigma);
    m.weight += w;
    m.model_centroid += w * pair.model;
    m.scene_centroid += w * pair.scene;
  }
  if (data.position_prior != nullptr) {  // A pair of the object's origin.
    const double w = 1 / isotropic_variance(*data.position_prior);
    m.weight += w;
    m.scene_centroid += w * data.position_prior->mean;
  }
  if (m.weight > 0) {
    m.model_centroid /= m.weight;
    m.scene_centroid /= m.weight;
  }
  const auto add_position = [&m](const Vector3d& model, const Vector3d& scene, double w) {
    const Vector3d x = model - m.model_centroid, y = scene - m.scene_centroid;
    m.attitude += (w * x) * y.transpose();
    m.constant -= 0.5 * w * (x.squaredNorm() + y.squaredNorm());
  };
  for (const OrientedPair& pair : data.oriented) {
    add_position(pair.model.point, pair.scene.point, inverse_square(pair.sigma));
    // κ (ey² + ez²) = κ/2 (1 - the cosine between the normals).
    const double kappa = compose(pair.model, pair.scene).kappa;
    if (!(kappa < 0)) continue;
    m.attitude += (-0.5 * kappa * axis_x(pair.model.orientation)) *
                  axis_x(pair.scene.orientation).transpose();
    m.constant += 0.5 * kappa;
  }
  for (const PositionPair& pair : data.positions) {
    add_position(pair.model, pair.scene, inverse_square(pair.sigma));
  }
  if (data.position_prior != nullptr) {
    add_position(Vector3d::Zero(), data.position_prior->mean,
                 1 / isotropic_variance(*data.position_prior));
  }
  return m;
}

CurvatureAttitude curvature_attitude(const OrientedPair& pair) {
  CurvatureAttitude result;
  const double lambda3 = compose(pair.model, pair.scene).lambda3;
  if (!(lambda3 < 0)) return result;
  // λ3 ex² = λ3/4 (1 + cos n - cos p - cos p'), of the angles between the ends' directions.
  const Matrix3d model = pair.model.orientation.toRotationMatrix();
  const Matrix3d scene = pair.scene.orientation.toRotationMatrix();
  const double weight = -0.25 * lambda3;
  result.along_normal = (-weight * model.col(0)) * scene.col(0).transpose();
  result.along_curvature = (weight * model.col(1)) * scene.col(1).transpose() +
                           (weight * model.col(2)) * scene.col(2).transpose();
  result.constant = -weight;
  result.present = true;
  return result;
}

std::uint64_t add_curvature(const Correspondences& data, const Matrix3d& rotation,
                            Moments& moments) {
  std::uint64_t hash = 1469598103934665603ULL;
  for (const OrientedPair& pair : data.oriented) {
    const CurvatureAttitude term = curvature_attitude(pair);
    if (!term.present) continue;
    const bool reversed = rotation.transpose().cwiseProduct(term.along_curvature).sum() < 0;
    moments.attitude += term.with_sign(reversed);
    moments.constant += term.constant;
    hash = (hash ^ (reversed ? 2U : 1U)) * 1099511628211ULL;
  }
  return hash;
}

void add_curvature(const Correspondences& data, Moments& moments) {
  for (const OrientedPair& pair : data.oriented) {
    const CurvatureAttitude term = curvature_attitude(pair);
    if (!term.present) continue;
    moments.attitude += term.with_sign(false);
    moments.constant += term.constant;
  }
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
