// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/refinement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "core/base/dispatch.hpp"
#include "core/detect/matches.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"
#include "core/score/projected_block.hpp"

namespace bpa::detect {
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
    const Eigen::Vector3f turning = lever.cross(direction);
    row << direction.x(), direction.y(), direction.z(), turning.x(), turning.y(), turning.z();
    information.noalias() += weight * row * row.transpose();
    gradient += weight * residual * row;
  }
};

// Tukey's biweight of a residual that is cut off at `gate`, over its variance.
inline float weight_of(float residual, float gate, float sigma) {
  const float ratio = residual / gate;
  const float inside = 1 - ratio * ratio;
  const float robust = inside > 0 ? inside : 0;
  return robust * robust / (sigma * sigma);
}

// The observed surface at the pixels of a block of model points. Camera frame, metres.
struct ObservedBlock {
  float point[3][kCheckBlock], normal[3][kCheckBlock];
  float matched[kCheckBlock];  // 1; 0 where there is none within the gate along the optical axis
};

// False where no point of the block has surface within the gate.
bool look_up(const SceneFeatures& scene, const score::ProjectedBlock& model, float gate,
             ObservedBlock& out) {
  bool any = false;
  for (int k = 0; k < kCheckBlock; ++k) {
    out.matched[k] = 0;
    for (int axis = 0; axis < 3; ++axis) out.point[axis][k] = out.normal[axis][k] = 0;
    if (model.pixel[k] < 0) continue;
    const auto pixel = static_cast<std::size_t>(model.pixel[k]);
    const CheckPixel& seen = scene.image.pixels[pixel];
    if (!seen.searched || std::abs(seen.depth - model.point[2][k]) >= gate) continue;
    out.matched[k] = 1;
    any = true;
    for (int axis = 0; axis < 3; ++axis) {
      out.point[axis][k] = scene.map.points[pixel][axis];
      out.normal[axis][k] = scene.map.normals[pixel][axis];
    }
  }
  return any;
}

// Sums over surface points, lane by lane: the same for any width of vectors.
struct SurfaceSums {
  using Lanes = std::array<float, kCheckBlock>;
  std::array<Lanes, 21> information{};  // the upper triangle, row by row
  std::array<Lanes, 6> gradient{};
  Lanes matched{};

  static float of(const Lanes& lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0f); }

  NormalEquations equations() const {
    NormalEquations out;
    int entry = 0;
    for (int row = 0; row < 6; ++row) {
      out.gradient[row] = of(gradient[row]);
      for (int column = row; column < 6; ++column) {
        out.information(row, column) = out.information(column, row) = of(information[entry++]);
      }
    }
    out.count = static_cast<int>(of(matched));
    return out;
  }
};

// Adds the distances of a block's points to the observed tangent planes, as NormalEquations::add
// does. Straight-line code over arrays, so that the compiler uses the widest vectors there are.
BPA_DISPATCH void add_block(const score::ProjectedBlock& model, const ObservedBlock& observed,
                            const SensorNoise& noise, const Eigen::Vector3f& centre, float gate,
                            SurfaceSums& __restrict sums) {
  const SensorNoise depth_noise = noise;
  const float cx = centre.x(), cy = centre.y(), cz = centre.z();
  float row[6][kCheckBlock], weighted[6][kCheckBlock], residual[kCheckBlock];
  for (int k = 0; k < kCheckBlock; ++k) {
    const float x = model.point[0][k], y = model.point[1][k], z = model.point[2][k];
    const float nx = observed.normal[0][k], ny = observed.normal[1][k], nz = observed.normal[2][k];
    const float dx = x - observed.point[0][k], dy = y - observed.point[1][k],
                dz = z - observed.point[2][k];
    const float cosine =
        nx * model.normal[0][k] + ny * model.normal[1][k] + nz * model.normal[2][k];
    const bool near = dx * dx + dy * dy + dz * dz < gate * gate;
    const float matched = near & (cosine > kMatchCosine) ? observed.matched[k] : 0;
    sums.matched[k] += matched;
    residual[k] = nx * dx + ny * dy + nz * dz;
    const float sigma = depth_noise(observed.point[2][k]) + tolerance::kModelSigma;
    const float weight = matched * weight_of(residual[k], gate, sigma);
    const float lx = x - cx, ly = y - cy, lz = z - cz;
    row[0][k] = nx, row[1][k] = ny, row[2][k] = nz;
    row[3][k] = ly * nz - lz * ny, row[4][k] = lz * nx - lx * nz, row[5][k] = lx * ny - ly * nx;
    for (int i = 0; i < 6; ++i) weighted[i][k] = weight * row[i][k];
  }
  int entry = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < kCheckBlock; ++k) sums.gradient[i][k] += weighted[i][k] * residual[k];
    for (int j = i; j < 6; ++j, ++entry) {
      for (int k = 0; k < kCheckBlock; ++k) {
        sums.information[entry][k] += weighted[i][k] * row[j][k];
      }
    }
  }
}

// One alignment problem. Unknowns: translation, then rotation about the object's origin; both along
// the camera's axes.
struct Problem {
  const SceneFeatures& scene;
  const ObjectModel& model;
  const ViewSample& view;  // the nearest one's
  const RefinementOptions& options;

  NormalEquations build(const Pose& pose, float gate) const {
    const FastPose fast = to_fast(pose);
    const Eigen::Vector3f centre = pose.translation.cast<float>();
    NormalEquations equations = surface(fast, centre, gate);
    add_edges(fast, centre, gate, equations);
    return equations;
  }

  NormalEquations surface(const FastPose& pose, const Eigen::Vector3f& centre, float gate) const {
    const CheckPoints& points = model.index->check;
    const int last = std::min(static_cast<int>(points.points.size()), options.max_points);
    SurfaceSums sums;
    score::ProjectedBlock block;
    ObservedBlock observed;
    for (int first = 0; first < last; first += kCheckBlock) {
      block.project(scene.image, points, pose, first, kMatchFacing);
      std::fill(block.pixel + std::min(kCheckBlock, last - first), block.pixel + kCheckBlock, -1);
      if (!look_up(scene, block, gate, observed)) continue;
      add_block(block, observed, scene.image.noise, centre, gate, sums);
    }
    return sums.equations();
  }

  // Edge points of the model against where the observed surface ends. From one side, only edges
  // tell where the object is across the view.
  void add_edges(const FastPose& pose, const Eigen::Vector3f& centre, float gate,
                 NormalEquations& equations) const {
    const std::size_t last = std::min<std::size_t>(view.num_edges, options.max_edges);
    for (std::size_t k = 0; k < last; ++k) {
      const EdgePoint edge = edge_point(view.edge(k), pose);
      const std::optional<float> offset = match_edge(scene.image, edge, gate);
      if (!offset) continue;
      const float sigma =
          tolerance::kEdgeSigma + 0.5f * edge.point.z() / scene.image.fx;  // half a pixel
      const float weight = weight_of(*offset, gate, sigma);
      equations.add(edge.outward, edge.point - centre, -*offset, weight);
    }
  }
};

// Keeps directions that no correspondence sees where they were.
Matrix6f damping(double diameter) {
  Matrix6f out = Matrix6f::Zero();
  constexpr float kPositionSigma = tolerance::placed(4);  // metres; of a turn, at half the diameter
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

}  // namespace bpa::detect
