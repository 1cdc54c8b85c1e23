// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace bpa::eval {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxQueries = 2000;

Eigen::Matrix3Xd transformed(const Points& points, const Pose& pose) {
  const Eigen::Map<const Eigen::Matrix3Xf> all(reinterpret_cast<const float*>(points.data()), 3,
                                               static_cast<Eigen::Index>(points.size()));
  return (pose.matrix() * all.cast<double>()).colwise() + pose.translation;
}

/// Largest squared column difference, given up once it exceeds `limit`.
template <class A, class B>
double max_squared_difference(const A& a, const B& b, double limit) {
  double largest = 0;
  for (Eigen::Index i = 0; i < a.cols() && largest < limit; ++i) {
    largest = std::max(largest, (a.col(i) - b.col(i)).squaredNorm());
  }
  return largest;
}

Eigen::Matrix2Xd projected(const Eigen::Matrix3Xd& points, const Camera& camera) {
  Eigen::Matrix2Xd pixels(2, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const bool visible = points(2, i) > 0;
    pixels.col(i) = visible ? camera.project(points.col(i)) : Eigen::Vector2d::Constant(kInfinity);
  }
  return pixels;
}

}  // namespace

bool is_right(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry) {
  constexpr double kNowhereNear = 0.2;
  if ((estimate.translation - truth.translation).norm() > kNowhereNear) return false;
  const PoseError error = pose_error(estimate, truth, symmetry);
  return error.position < kPoseTolerance_m && error.angle < kPoseTolerance_rad;
}

std::vector<Pose> discretised_symmetries(const SymmetryGroup& group, double max_step) {
  const std::vector<Pose> discrete = discrete_elements(group);
  if (group.continuous.empty()) return discrete;
  // On the circle a vertex is at most half a diameter from the axis.
  const int steps = static_cast<int>(std::ceil(std::numbers::pi / max_step));
  std::vector<Pose> result;
  for (const ContinuousSymmetry& symmetry : group.continuous) {
    for (const Pose& element : discrete) {
      for (int step = 0; step < steps; ++step) {
        const double angle = 2 * std::numbers::pi * step / steps;
        const Eigen::Quaterniond turn = rotation_from_vector(angle * symmetry.axis);
        const Pose about_axis{turn, symmetry.point - turn * symmetry.point};
        result.push_back(about_axis * element);
      }
    }
  }
  return result;
}

double average_distance(const Points& points, const Pose& estimate, const Pose& truth) {
  if (points.empty()) return 0;
  return (transformed(points, estimate) - transformed(points, truth)).colwise().norm().mean();
}

double average_nearest_distance(const Points& points, const Pose& estimate, const Pose& truth) {
  if (points.empty()) return 0;
  const Pose estimate_from_truth = estimate.inverse() * truth;
  const Eigen::Matrix3Xf all = transformed(points, Pose{}).cast<float>();
  const std::size_t step = (points.size() + kMaxQueries - 1) / kMaxQueries;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); i += step, ++count) {
    const Eigen::Vector3f query = (estimate_from_truth * points[i].cast<double>()).cast<float>();
    sum += std::sqrt((all.colwise() - query).colwise().squaredNorm().minCoeff());
  }
  return sum / static_cast<double>(count);
}

double rms_distance(const Points& points, const Pose& estimate, const Pose& truth,
                    const std::vector<Pose>& symmetries) {
  if (points.empty()) return 0;
  const Eigen::Matrix3Xd at_estimate = transformed(points, estimate);
  double best = kInfinity;
  for (const Pose& symmetry : symmetries) {
    const Eigen::Matrix3Xd at_truth = transformed(points, truth * symmetry);
    best = std::min(best, (at_estimate - at_truth).colwise().squaredNorm().mean());
  }
  return std::sqrt(best);
}

double max_surface_distance(const Points& points, const Pose& estimate, const Pose& truth,
                            const std::vector<Pose>& symmetries) {
  const Eigen::Matrix3Xd at_estimate = transformed(points, estimate);
  double best = kInfinity;
  for (const Pose& symmetry : symmetries) {
    best = std::min(
        best, max_squared_difference(at_estimate, transformed(points, truth * symmetry), best));
  }
  return std::sqrt(best);
}

double max_projection_distance(const Points& points, const Pose& estimate, const Pose& truth,
                               const std::vector<Pose>& symmetries, const Camera& camera) {
  const Eigen::Matrix2Xd at_estimate = projected(transformed(points, estimate), camera);
  if (!at_estimate.allFinite()) return kInfinity;
  double best = kInfinity;
  for (const Pose& symmetry : symmetries) {
    const Eigen::Matrix2Xd at_truth = projected(transformed(points, truth * symmetry), camera);
    best = std::min(best, max_squared_difference(at_estimate, at_truth, best));
  }
  return std::sqrt(best);
}

std::array<double, 10> visible_surface_discrepancy(const std::vector<float>& depth_estimate,
                                                   const std::vector<float>& depth_truth,
                                                   const std::vector<float>& depth_measured,
                                                   const Camera& camera, double diameter,
                                                   double delta) {
  std::array<double, 10> over{};  // pixels of the intersection that differ too much
  double both = 0, either = 0;
  for (std::size_t i = 0; i < depth_measured.size(); ++i) {
    if (!(depth_estimate[i] > 0) && !(depth_truth[i] > 0)) continue;
    // Distances from the camera's centre, not depths.
    const int row = static_cast<int>(i) / camera.width, column = static_cast<int>(i) % camera.width;
    const double length = camera.unproject(column, row, 1).norm();
    const double measured = length * depth_measured[i];
    const auto visible = [&](double distance) {
      return distance > 0 && (!(measured > 0) || distance - measured <= delta);
    };
    const double estimate = length * depth_estimate[i];
    const double truth = length * depth_truth[i];
    const bool truth_visible = visible(truth);
    const bool estimate_visible = visible(estimate) || (truth_visible && estimate > 0);
    either += truth_visible || estimate_visible;
    if (!truth_visible || !estimate_visible) continue;
    ++both;
    const double difference = std::abs(estimate - truth) / diameter;
    for (std::size_t k = 0; k < over.size(); ++k) over[k] += difference >= kBopThresholds[k];
  }
  for (double& value : over) value = either > 0 ? (value + either - both) / either : 1.0;
  return over;
}

}  // namespace bpa::eval
