// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace bpa::eval {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxQueries = 2000;
constexpr double kNearest = 0.01;  // of a vertex that is rendered, metres

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

struct Vertex {
  Eigen::Vector2d pixel;
  double inverse_depth = 0;  // linear in the image; 0 where the vertex is too near
};

void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, const Camera& camera,
                   std::vector<float>& depth) {
  const Eigen::Vector2d ab = b.pixel - a.pixel;
  const Eigen::Vector2d ac = c.pixel - a.pixel;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (area == 0 || !std::isfinite(area)) return;
  const Eigen::Vector2d low = a.pixel.cwiseMin(b.pixel).cwiseMin(c.pixel);
  const Eigen::Vector2d high = a.pixel.cwiseMax(b.pixel).cwiseMax(c.pixel);
  const int left = static_cast<int>(std::ceil(std::max(low.x(), 0.0)));
  const int right = static_cast<int>(std::floor(std::min(high.x(), camera.width - 1.0)));
  const int top = static_cast<int>(std::ceil(std::max(low.y(), 0.0)));
  const int bottom = static_cast<int>(std::floor(std::min(high.y(), camera.height - 1.0)));
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const Eigen::Vector2d p = Eigen::Vector2d(u, v) - a.pixel;
      const double wb = (p.x() * ac.y() - p.y() * ac.x()) / area;
      const double wc = (ab.x() * p.y() - ab.y() * p.x()) / area;
      if (wb < 0 || wc < 0 || wb + wc > 1) continue;
      const double inverse =
          (1 - wb - wc) * a.inverse_depth + wb * b.inverse_depth + wc * c.inverse_depth;
      float& z = depth[v * camera.width + u];
      const auto here = static_cast<float>(1 / inverse);
      if (z == 0 || here < z) z = here;
    }
  }
}

}  // namespace

double right_cost(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry,
                  double position_m, double angle_rad) {
  const PoseError error = pose_error(estimate, truth, symmetry, position_m, angle_rad);
  const double cost = std::max(error.position / position_m, error.angle / angle_rad);
  return cost <= 1 ? cost : kNoMatch;
}

bool is_right(const Pose& estimate, const Pose& truth, const SymmetryGroup& symmetry) {
  constexpr double kNowhereNear = 0.2;
  if ((estimate.translation - truth.translation).norm() > kNowhereNear) return false;
  return right_cost(estimate, truth, symmetry) < 1;
}

bool is_right_about_any(const Pose& estimate, const ObjectModel& model,
                        const std::vector<io::BopInstance>& truth) {
  return std::ranges::any_of(truth, [&](const io::BopInstance& instance) {
    return instance.obj_id == model.number &&
           is_right(estimate, instance.camera_from_object, model.symmetry);
  });
}

std::vector<int> match_greedily(const std::vector<double>& scores,
                                const std::vector<std::vector<double>>& costs, double limit) {
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t e) { return scores[e]; });
  std::vector<int> truth_of(scores.size(), -1);
  std::vector<bool> taken(costs.empty() ? 0 : costs.front().size(), false);
  for (const std::size_t e : order) {
    double best = limit;
    for (std::size_t t = 0; t < taken.size(); ++t) {
      if (taken[t] || !(costs[e][t] < best)) continue;
      best = costs[e][t];
      truth_of[e] = static_cast<int>(t);
    }
    if (truth_of[e] >= 0) taken[truth_of[e]] = true;
  }
  return truth_of;
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

std::vector<float> render_depth(const TriangleMesh& mesh, const Pose& camera_from_object,
                                const Camera& camera) {
  std::vector<float> depth(camera.width * camera.height, 0.0f);
  std::vector<Vertex> vertices;
  const Eigen::Matrix3d rotation = camera_from_object.matrix();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d p = rotation * vertex.cast<double>() + camera_from_object.translation;
    vertices.push_back(p.z() > kNearest ? Vertex{camera.project(p), 1 / p.z()} : Vertex{});
  }
  for (const auto& triangle : mesh.triangles) {
    const Vertex& a = vertices[triangle[0]];
    const Vertex& b = vertices[triangle[1]];
    const Vertex& c = vertices[triangle[2]];
    const bool visible = a.inverse_depth > 0 && b.inverse_depth > 0 && c.inverse_depth > 0;
    if (visible) draw_triangle(a, b, c, camera, depth);
  }
  return depth;
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
