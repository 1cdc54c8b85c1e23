// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <bpa/core/align/align.hpp>
#include <bpa/core/align/moments.hpp>
#include <bpa/core/bingham/eigen4.hpp>

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

// The pair whose curvature direction says most, or null.
const OrientedPair* most_curved(const Correspondences& data) {
  const OrientedPair* best = nullptr;
  double least = 0;
  for (const OrientedPair& pair : data.oriented) {
    const double lambda3 = std::max(pair.model.lambda3, pair.scene.lambda3);
    if (lambda3 < least) {
      least = lambda3;
      best = &pair;
    }
  }
  return best;
}

// Maximises over the signs of the curvature directions: given a rotation the best signs are plain,
// given signs the best rotation is an eigenvector, and neither step lowers the value.
Mode maximise_over_signs(const Correspondences& data, const Moments& moments, const Matrix4d& prior,
                         const OrientedPair& strongest) {
  const CurvatureAttitude term = curvature_attitude(strongest);
  std::array<std::uint64_t, 3> reached{};
  Mode best(moments, prior);
  for (std::size_t start = 0; start < reached.size(); ++start) {
    Mode mode = best;
    if (start > 0) {
      Moments with_strongest = moments;
      with_strongest.attitude += term.with_sign(start == 2);
      mode = Mode(with_strongest, prior);
    }
    std::uint64_t signs = 0;
    bool known = false;
    for (int iteration = 0; iteration < 20; ++iteration) {
      Moments with_signs = moments;
      const std::uint64_t previous = signs;
      signs = add_curvature(data, mode.rotation(), with_signs);
      known = signs == reached[0] || signs == reached[1];
      if (known || signs == previous) break;
      mode = Mode(with_signs, prior);
    }
    reached[start] = signs;
    if (!known && (start == 0 || mode.value > best.value)) best = mode;
  }
  return best;
}

PoseEstimate make_estimate(const Mode& mode, const Moments& moments) {
  PoseEstimate result;
  result.camera_from_object.rotation = from_wxyz(mode.q);
  if (moments.weight > 0) {
    result.camera_from_object.translation =
        moments.scene_centroid - result.camera_from_object.rotation * moments.model_centroid;
  }
  result.exponent = mode.exponent;
  result.position_weight = moments.weight;
  result.model_centroid = moments.model_centroid;
  result.log_score = mode.value;
  return result;
}

Matrix4d prior_exponent(const Correspondences& data) {
  return data.orientation_prior == nullptr ? Matrix4d::Zero() : data.orientation_prior->exponent();
}

}  // namespace

PoseEstimate bpa_mode(const Correspondences& data) {
  Moments moments = accumulate(data);
  const Matrix4d prior = prior_exponent(data);
  const OrientedPair* strongest = most_curved(data);
  if (strongest != nullptr && !data.curvature_sign_known) {
    return make_estimate(maximise_over_signs(data, moments, prior, *strongest), moments);
  }
  if (strongest != nullptr) add_curvature(data, moments);
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

namespace {

// Horn's moments: positions with their weights, nothing else.
Moments position_moments(const Correspondences& data) {
  Moments m;
  const auto each = [&data](auto&& visit) {
    for (const OrientedPair& pair : data.oriented) {
      visit(pair.model.point, pair.scene.point, 1 / (pair.sigma * pair.sigma));
    }
    for (const PositionPair& pair : data.positions) {
      visit(pair.model, pair.scene, 1 / (pair.sigma * pair.sigma));
    }
  };
  each([&m](const Vector3d& model, const Vector3d& scene, double w) {
    m.weight += w;
    m.model_centroid += w * model;
    m.scene_centroid += w * scene;
  });
  if (!(m.weight > 0)) return m;
  m.model_centroid /= m.weight;
  m.scene_centroid /= m.weight;
  each([&m](const Vector3d& model, const Vector3d& scene, double w) {
    const Vector3d x = model - m.model_centroid, y = scene - m.scene_centroid;
    m.attitude += (w * x) * y.transpose();
    m.constant -= 0.5 * w * (x.squaredNorm() + y.squaredNorm());
  });
  return m;
}

}  // namespace

PoseEstimate icp_mode(const Correspondences& data) {
  const Moments moments = position_moments(data);
  return make_estimate(Mode(moments, Matrix4d::Zero()), moments);
}

}  // namespace bpa::align
