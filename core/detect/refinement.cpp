// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/refinement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <span>

#include "core/detect/matches.hpp"
#include "core/model/model_index.hpp"

namespace bpa {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

struct NormalEquations {
  Matrix6f information = Matrix6f::Zero();
  Vector6f gradient = Vector6f::Zero();
  int count = 0;

  // One residual along `direction` of a point `lever` away from the centre of rotation.
  void add(const Eigen::Vector3f& direction, const Eigen::Vector3f& lever, float residual,
           float weight) {
    Vector6f row;
    row << direction, lever.cross(direction);
    information.noalias() += weight * row * row.transpose();
    gradient += weight * residual * row;
  }
};

// Tukey's biweight of a residual that is cut off at `gate`, over its variance.
float weight_of(float residual, float gate, float sigma) {
  const float ratio = residual / gate;
  const float robust = std::max(0.0f, 1 - ratio * ratio);
  return robust * robust / (sigma * sigma);
}

// One alignment problem. Unknowns: translation, then rotation about the object's origin; both along
// the camera's axes.
struct Problem {
  const SceneFeatures& scene;
  const ObjectModel& model;
  const ViewSample& view;  // the nearest one's
  const RefinementOptions& options;

  NormalEquations build(const Pose& pose, float gate) const {
    NormalEquations equations;
    const FastPose fast = to_fast(pose);
    const Eigen::Vector3f centre = pose.translation.cast<float>();
    add_surface(fast, centre, gate, equations);
    add_edges(fast, centre, gate, equations);
    return equations;
  }

  void add_surface(const FastPose& pose, const Eigen::Vector3f& centre, float gate,
                   NormalEquations& equations) const {
    constexpr float kModelSigma = 0.001f;  // metres, beside the sensor's noise
    const CheckPoints& points = model.index->check;
    const auto last = std::min<std::size_t>(points.points.size(), options.max_points);
    SurfaceMatch match;
    for (std::size_t i = 0; i < last; ++i) {
      if (!match_surface(scene, points, i, pose, gate, match)) continue;
      const float residual = match.scene_normal.dot(match.model_point - match.scene_point);
      const float sigma = scene.map.noise(match.scene_point.z()) + kModelSigma;
      const float weight = weight_of(residual, gate, sigma);
      equations.add(match.scene_normal, match.model_point - centre, residual, weight);
      ++equations.count;
    }
  }

  // Edge points of the model against where the observed surface ends. From one side, only edges
  // tell where the object is across the view.
  void add_edges(const FastPose& pose, const Eigen::Vector3f& centre, float gate,
                 NormalEquations& equations) const {
    // Of the edges of the nearest of 66 views; a pixel's half width is added.
    constexpr float kEdgeSigma = 0.004f;
    const std::size_t last = std::min<std::size_t>(view.edges.size(), options.max_edges);
    for (const ViewEdge& of_view : std::span(view.edges).first(last)) {
      const EdgePoint edge = edge_point(of_view, pose);
      const std::optional<float> offset = match_edge(scene.image, edge, gate);
      if (!offset) continue;
      const float sigma = kEdgeSigma + 0.5f * edge.point.z() / scene.image.fx;
      const float weight = weight_of(*offset, gate, sigma);
      equations.add(edge.outward, edge.point - centre, -*offset, weight);
    }
  }
};

// Keeps directions that no correspondence sees where they were.
Matrix6f damping(double diameter) {
  Matrix6f out = Matrix6f::Zero();
  constexpr float kPositionSigma = 0.01f;  // metres; of a turn, at half the diameter
  const float position = 1 / (kPositionSigma * kPositionSigma);
  const float angle = position * static_cast<float>(0.25 * diameter * diameter);
  out.diagonal() << position, position, position, angle, angle, angle;
  return out;
}

// Aligns; with `last`, sets the equations at the pose it ends with.
Pose gauss_newton(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                  const RefinementOptions& options, NormalEquations* last) {
  constexpr int kMinMatches = 6;  // unknowns
  Pose pose = start;
  const Matrix6f prior = damping(model.diameter);
  const FastPose fast_start = to_fast(start);
  const ViewSample& view = sample_of(model, nearest_view(model.index->views, fast_start));
  const Problem problem{scene, model, view, options};
  const auto start_gate = static_cast<float>(options.start_gate_m);
  const auto end_gate = static_cast<float>(options.end_gate_m);
  const int builds = options.iterations + (last ? 1 : 0);
  for (int k = 0; k < builds; ++k) {
    const float part = static_cast<float>(k) / static_cast<float>(std::max(1, options.iterations));
    const NormalEquations equations =
        problem.build(pose, start_gate + part * (end_gate - start_gate));
    if (last) *last = equations;
    if (k == options.iterations || equations.count < kMinMatches) break;
    const Vector6f step = -(equations.information + prior).ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    pose.translation += step.head<3>().cast<double>();
    pose.rotation =
        (rotation_from_vector(step.tail<3>().cast<double>()) * pose.rotation).normalized();
  }
  return pose;
}

}  // namespace

Refinement refine_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                       const RefinementOptions& options) {
  NormalEquations last;
  const Pose pose = gauss_newton(scene, model, start, options, &last);
  return {pose, last.information.cast<double>(), last.count};
}

Pose aligned_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                  const RefinementOptions& options) {
  return gauss_newton(scene, model, start, options, nullptr);
}

}  // namespace bpa
