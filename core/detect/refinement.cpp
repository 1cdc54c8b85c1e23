// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/refinement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/align/align.hpp"
#include "core/base/random.hpp"
#include "core/detect/edge_matches.hpp"
#include "core/model/model_index.hpp"

namespace bpa {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

struct Match {
  Eigen::Vector3f model_point, model_normal;  // in the camera frame
  Eigen::Vector3f scene_point, scene_normal;
  std::size_t pixel = 0;
};

// The observed surface at the pixel that a model point falls on, if it is near and faces the same
// way.
bool match_point(const SceneFeatures& scene, const CheckPoints& model, std::size_t i,
                 const FastPose& pose, float gate, Match& match) {
  match.model_normal = pose.rotation * model.normals[i];
  match.model_point = pose * model.points[i];
  const Eigen::Vector3f& p = match.model_point;
  if (p.z() < 0.1f || match.model_normal.dot(p) > -0.1f * p.z()) return false;
  const CheckImage& image = scene.image;
  const auto u = static_cast<int>(std::floor(image.fx * p.x() / p.z() + image.cx + 0.5f));
  const auto v = static_cast<int>(std::floor(image.fy * p.y() / p.z() + image.cy + 0.5f));
  if (u < 0 || v < 0 || u >= image.width || v >= image.height) return false;
  const auto index = static_cast<std::size_t>(v * image.width + u);
  if (!scene.map.searched[index]) return false;
  match.pixel = index;
  match.scene_point = scene.map.points[index];
  match.scene_normal = scene.map.normals[index];
  return (match.scene_point - p).squaredNorm() < gate * gate &&
         match.scene_normal.dot(match.model_normal) > 0.6f;
}

struct NormalEquations {
  Matrix6f information = Matrix6f::Zero();
  Vector6f gradient = Vector6f::Zero();
  int count = 0;
};

// Unknowns: translation, then rotation about `centre`; both along the camera's axes.
NormalEquations build(const SceneFeatures& scene, const CheckPoints& model, const FastPose& pose,
                      const Eigen::Vector3f& centre, float gate, int max_points) {
  NormalEquations equations;
  const auto last = std::min(model.points.size(), static_cast<std::size_t>(max_points));
  Match match;
  for (std::size_t i = 0; i < last; ++i) {
    if (!match_point(scene, model, i, pose, gate, match)) continue;
    const float residual = match.scene_normal.dot(match.model_point - match.scene_point);
    const float sigma = depth_noise(match.scene_point.z()) + 0.001f;
    const float ratio = residual / gate;
    const float robust = std::max(0.0f, 1 - ratio * ratio);
    const float weight = robust * robust / (sigma * sigma);
    Vector6f row;
    row.head<3>() = match.scene_normal;
    row.tail<3>() = (match.model_point - centre).cross(match.scene_normal);
    equations.information.noalias() += weight * row * row.transpose();
    equations.gradient += weight * residual * row;
    ++equations.count;
  }
  return equations;
}

// Edge points of the model against where the observed surface ends: what is seen of an object from
// one side says by its edges alone where across the view it is.
void add_edges(const SceneFeatures& scene, const ObjectModel& model, const ModelView& view,
               const FastPose& pose, const Eigen::Vector3f& centre, float gate, int max_edges,
               NormalEquations& equations) {
  if (max_edges == 0 || view.edges.empty()) return;
  const std::size_t step =
      std::max<std::size_t>(1, view.edges.size() / static_cast<std::size_t>(max_edges));
  for (std::size_t k = 0; k < view.edges.size(); k += step) {
    const EdgePoint edge = edge_point(model, view, pose, k);
    const std::optional<float> offset = match_edge(scene.image, edge, gate);
    if (!offset) continue;
    // A pixel's width, and what the edges of the nearest of the 66 views are off by.
    const float sigma = 0.004f + 0.5f * edge.point.z() / scene.image.fx;
    const float ratio = *offset / gate;
    const float robust = std::max(0.0f, 1 - ratio * ratio);
    const float weight = robust * robust / (sigma * sigma);
    Vector6f row;
    row.head<3>() = edge.outward;
    row.tail<3>() = (edge.point - centre).cross(edge.outward);
    equations.information.noalias() += weight * row * row.transpose();
    equations.gradient -= weight * *offset * row;
  }
}

// Keeps directions that no correspondence sees where they were.
Matrix6f damping(double diameter) {
  Matrix6f out = Matrix6f::Zero();
  const float position = 1 / (0.01f * 0.01f);
  const float angle = position * static_cast<float>(0.25 * diameter * diameter);
  out.diagonal() << position, position, position, angle, angle, angle;
  return out;
}

}  // namespace

Refinement refine_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                       const RefinementOptions& options) {
  Refinement out;
  Pose pose = start;
  const Matrix6f prior = damping(model.diameter);
  const FastPose seen_from = to_fast(start);
  const ModelView& view = nearest_view(model.index->views, seen_from);
  for (int k = 0; k <= options.iterations; ++k) {
    const float part = static_cast<float>(k) / static_cast<float>(std::max(1, options.iterations));
    const float gate = options.start_gate_m + part * (options.end_gate_m - options.start_gate_m);
    const Eigen::Vector3f centre = pose.translation.cast<float>();
    const FastPose fast = to_fast(pose);
    NormalEquations equations =
        build(scene, model.index->check, fast, centre, gate, options.max_points);
    add_edges(scene, model, view, fast, centre, gate, options.max_edges, equations);
    out.num_correspondences = equations.count;
    out.information = equations.information.cast<double>();
    if (k == options.iterations || equations.count < 6) break;
    const Vector6f step = -(equations.information + prior).ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    pose.translation += step.head<3>().cast<double>();
    pose.rotation =
        (rotation_from_vector(step.tail<3>().cast<double>()) * pose.rotation).normalized();
  }
  out.camera_from_object = pose;
  return out;
}

namespace {

// A random part of the super-pixels: surface that is not the object's is left out now and then.
bool segment_sampled(std::int32_t segment, std::uint64_t seed) {
  constexpr double kShare = 0.7;
  return segment >= 0 && RandomStream(seed, static_cast<std::uint64_t>(segment)).uniform() < kShare;
}

// Where a model edge point is matched with the frame, a pair of positions.
void add_edge_pairs(const SceneFeatures& scene, const ObjectModel& model, const FastPose& pose,
                    float gate, int count, RandomStream& random,
                    std::vector<align::PositionPair>& pairs) {
  const ModelView& view = nearest_view(model.index->views, pose);
  if (view.edges.empty()) return;
  const auto wanted = static_cast<std::size_t>(count);
  for (int tries = 0; tries < 3 * count && pairs.size() < wanted; ++tries) {
    const auto k = static_cast<std::size_t>(random.index(static_cast<int>(view.edges.size())));
    const EdgePoint edge = edge_point(model, view, pose, k);
    const std::optional<float> offset = match_edge(scene.image, edge, gate);
    if (!offset) continue;
    const Eigen::Vector3f observed = edge.point + *offset * edge.outward;
    pairs.push_back({model.surface.points[view.edges[k]].cast<double>(), observed.cast<double>(),
                     0.5 * static_cast<double>(gate)});
  }
}

}  // namespace

Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, int count, std::uint64_t seed, const AlignmentCues& cues) {
  RandomStream random(seed, 17);
  const std::uint64_t segment_seed = random();
  const CheckPoints& check = model.index->check;
  const FastPose fast = to_fast(start);
  const int total = static_cast<int>(check.points.size());
  std::vector<align::OrientedPair> pairs;
  Match match;
  for (int tries = 0; tries < 8 * count && static_cast<int>(pairs.size()) < count; ++tries) {
    const auto i = static_cast<std::size_t>(random.index(total));
    if (!match_point(scene, check, i, fast, gate, match)) continue;
    if (cues.segments && !segment_sampled(scene.segmentation.labels[match.pixel], segment_seed)) {
      continue;
    }
    align::OrientedPair& pair = pairs.emplace_back();
    pair.model.point = check.points[i].cast<double>();
    pair.model.orientation = align::feature_orientation(check.normals[i].cast<double>());
    pair.scene.point = match.scene_point.cast<double>();
    pair.scene.orientation = align::feature_orientation(match.scene_normal.cast<double>());
    pair.sigma = 0.5 * static_cast<double>(gate);
  }
  if (pairs.size() < 4) return start;
  std::vector<align::PositionPair> edges;
  if (cues.edges) add_edge_pairs(scene, model, fast, gate, count / 2, random, edges);
  align::Correspondences data;
  data.oriented = pairs;
  data.positions = edges;
  return (cues.orientation ? align::bpa_mode(data) : align::icp_mode(data)).camera_from_object;
}

}  // namespace bpa
