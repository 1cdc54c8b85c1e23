// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/align/align.hpp"

#include <cstdint>

#include "core/align/moments.hpp"
#include "core/bingham/eigen4.hpp"

namespace bpa::align {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

struct Mode {
  Vector4d q = Vector4d::UnitX();
  Matrix4d exponent = Matrix4d::Zero();
  double value = 0;

  Mode(const Moments& moments, const Matrix4d& prior)
      : exponent(horn_matrix(moments.attitude) + prior) {
    q = dominant_eigenvector(exponent);
    value = moments.constant + q.dot(exponent * q);
  }
  Matrix3d rotation() const { return Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix(); }
};

// Adds every curvature direction with the sign that agrees with `rotation`; returns a hash of the
// signs.
std::uint64_t add_agreeing(const Correspondences& data, const CurvatureTerms& curvature,
                           const Matrix3d& rotation, Matrix3d& attitude) {
  std::uint64_t hash = 1469598103934665603ULL;
  curvature.for_each(data, [&](const CurvatureTerm& term) {
    const bool reversed = term.value(rotation) < 0;
    attitude += (reversed ? -1.0 : 1.0) * term.attitude;
    hash = (hash ^ (reversed ? 2U : 1U)) * 1099511628211ULL;
  });
  return hash;
}

// Given a rotation the best signs are plain, given signs the best rotation is an eigenvector, and
// neither step lowers the value.
Mode climb(const Correspondences& data, const Moments& moments, const CurvatureTerms& curvature,
           const Matrix4d& prior, const Mode& start) {
  Mode mode = start;
  std::uint64_t signs = 0;
  for (int iteration = 0; iteration < 20; ++iteration) {
    Moments with_signs = moments;
    const std::uint64_t previous = signs;
    signs = add_agreeing(data, curvature, mode.rotation(), with_signs.attitude);
    if (signs == previous) break;
    mode = Mode(with_signs, prior);
  }
  return mode;
}

// Maximises over the signs of the curvature directions, from the answer of positions and normals
// and then from the other sign of the strongest direction, unless a bound says that it cannot be
// better: no direction adds more than its `largest`.
Mode maximise_over_signs(const Correspondences& data, const Moments& moments,
                         const CurvatureTerms& curvature, const Matrix4d& prior) {
  const CurvatureTerm& strongest = curvature.strongest();
  Mode best = climb(data, moments, curvature, prior, Mode(moments, prior));
  const double sign = strongest.value(best.rotation()) < 0 ? -1 : 1;
  const double others = curvature.total() - strongest.largest;
  for (const double tried : {-sign, sign}) {
    Moments with_strongest = moments;
    with_strongest.attitude += tried * strongest.attitude;
    const Mode start(with_strongest, prior);
    if (start.value + others <= best.value) break;
    const Mode mode = climb(data, moments, curvature, prior, start);
    if (mode.value > best.value) best = mode;
  }
  return best;
}

PoseEstimate make_estimate(const Mode& mode, const Moments& moments) {
  Pose pose{from_wxyz(mode.q)};
  if (moments.weight > 0) {
    pose.translation = moments.scene_centroid - pose.rotation * moments.model_centroid;
  }
  return {pose, mode.exponent, mode.value};
}

Matrix4d prior_exponent(const Correspondences& data) {
  return data.orientation_prior == nullptr ? Matrix4d::Zero() : data.orientation_prior->exponent();
}

}  // namespace

PoseEstimate bpa_mode(const Correspondences& data) {
  CurvatureTerms curvature;
  Moments moments = accumulate(data, curvature);
  const Matrix4d prior = prior_exponent(data);
  if (curvature.count() > 0 && !data.curvature_sign_known) {
    return make_estimate(maximise_over_signs(data, moments, curvature, prior), moments);
  }
  curvature.for_each(data, [&](const CurvatureTerm& term) { moments.attitude += term.attitude; });
  return make_estimate(Mode(moments, prior), moments);
}

Pose bpa_sample_one(const OrientedPair& pair, RandomStream& random, bool curvature_sign_known) {
  const FeatureConcentration c = compose(pair.model, pair.scene);
  const Vector4d e = sample_diagonal_bingham({0, c.lambda3, c.kappa, c.kappa}, random);
  Quaterniond scene = pair.scene.orientation;
  if (!curvature_sign_known && c.lambda3 < 0 && random.uniform() < 0.5) {
    scene = reversed_curvature(scene);
  }
  const Quaterniond deviation(e[0], e[1], e[2], e[3]);
  Pose pose;
  pose.rotation = (scene * deviation * pair.model.orientation.conjugate()).normalized();
  const double x = random.normal(), y = random.normal(), z = random.normal();
  pose.translation =
      pair.scene.point + pair.sigma * Vector3d(x, y, z) - pose.rotation * pair.model.point;
  return pose;
}

PoseEstimate icp_mode(const Correspondences& data) {
  const Moments moments = accumulate_positions(data);
  return make_estimate(Mode(moments, Matrix4d::Zero()), moments);
}

}  // namespace bpa::align
