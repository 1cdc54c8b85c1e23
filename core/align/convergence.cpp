// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include <bpa/core/align/convergence.hpp>
#include <bpa/core/base/parallel.hpp>
#include <bpa/core/base/random.hpp>
#include <bpa/core/cloud/neighbor_grid.hpp>

namespace bpa::align {
namespace {

OrientedPoint oriented_point(const PointCloud& cloud, std::size_t i) {
  OrientedPoint out;
  out.point = cloud.points[i].cast<double>();
  const Eigen::Vector3d normal = cloud.normals[i].cast<double>();
  if (cloud.principal_directions.empty() || cloud.curvatures.empty()) {
    out.orientation = feature_orientation(normal);
    return out;
  }
  out.orientation = feature_orientation(normal, cloud.principal_directions[i].cast<double>());
  out.lambda3 = curvature_concentration(cloud.curvatures[i].x(), cloud.curvatures[i].y());
  return out;
}

// Finds correspondences of one placement.
class Matcher {
 public:
  Matcher(const TruePlacement& placement, const ConvergenceOptions& options)
      : model_(*placement.model),
        scene_(*placement.scene),
        options_(options),
        model_grid_(placement.model->points, static_cast<float>(options.gate_m)) {
    // Only what any start may reach.
    float radius = 0;
    for (const Eigen::Vector3f& p : model_.points) radius = std::max(radius, p.norm());
    const double reach = radius + options.gate_m + 4 * options.start_position_m + 0.05;
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      const Eigen::Vector3d p = scene_.points[i].cast<double>();
      if ((p - placement.camera_from_object.translation).norm() < reach &&
          scene_.normals[i].squaredNorm() > 0.5f) {
        candidates_.push_back(i);
      }
    }
  }

  void operator()(const Pose& pose, RandomStream& random, Matches& matches) const {
    const int count = static_cast<int>(candidates_.size());
    if (count == 0) return;
    const Pose object_from_camera = pose.inverse();
    const Eigen::Matrix3d rotation = object_from_camera.matrix();
    const auto cosine = static_cast<float>(std::cos(options_.gate_deg * M_PI / 180));
    for (int tries = 0; tries < 40 * options_.points; ++tries) {
      const std::size_t i = candidates_[static_cast<std::size_t>(random.index(count))];
      const Eigen::Vector3f p =
          (object_from_camera * scene_.points[i].cast<double>()).cast<float>();
      const Eigen::Vector3f n = (rotation * scene_.normals[i].cast<double>()).cast<float>();
      const int nearest = nearest_facing(p, n, cosine);
      if (nearest < 0) continue;
      matches.oriented.push_back({oriented_point(model_, static_cast<std::size_t>(nearest)),
                                  oriented_point(scene_, i), options_.sigma_m});
      if (static_cast<int>(matches.oriented.size()) == options_.points) break;
    }
  }

 private:
  int nearest_facing(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float cosine) const {
    int nearest = -1;
    float least = INFINITY;
    model_grid_.for_each_neighbor(p, [&](int index, float squared) {
      if (squared < least && model_.normals[static_cast<std::size_t>(index)].dot(n) > cosine) {
        least = squared;
        nearest = index;
      }
    });
    return nearest;
  }

  const PointCloud& model_;
  const PointCloud& scene_;
  const ConvergenceOptions& options_;
  NeighborGrid model_grid_;
  std::vector<std::size_t> candidates_;
};

Pose disturb(const Pose& truth, const ConvergenceOptions& options, RandomStream& random) {
  Eigen::Vector3d move, turn;
  for (int i = 0; i < 3; ++i) move[i] = options.start_position_m * random.normal();
  for (int i = 0; i < 3; ++i) turn[i] = options.start_angle_deg * M_PI / 180 * random.normal();
  return {(rotation_from_vector(turn) * truth.rotation).normalized(), truth.translation + move};
}

// The least errors so far, after each step of one trial.
ConvergenceCurve run_trial(const TruePlacement& placement, const Matcher& matcher,
                           const Pose& start, Method method, RandomStream random, int iterations) {
  IterationOptions iteration;
  iteration.method = method;
  iteration.max_iterations = iterations;
  const IterationResult result = iterate(
      start, [&](const Pose& pose, Matches& m) { matcher(pose, random, m); }, iteration);
  ConvergenceCurve curve;
  double position = INFINITY, angle = INFINITY;
  for (int k = 0; k <= iterations; ++k) {
    const auto step = static_cast<std::size_t>(k);
    if (step <= result.poses.size()) {
      const PoseError error = pose_error(k == 0 ? start : result.poses[step - 1],
                                         placement.camera_from_object, placement.symmetry);
      position = std::min(position, error.position);
      angle = std::min(angle, error.angle);
    }
    curve.position_m.push_back(position);
    curve.angle_rad.push_back(angle);
  }
  return curve;
}

void add_mean(const std::vector<ConvergenceCurve>& curves, ConvergenceCurve& mean) {
  const double share = 1.0 / static_cast<double>(curves.size());
  for (const ConvergenceCurve& curve : curves) {
    mean.position_m.resize(curve.position_m.size(), 0);
    mean.angle_rad.resize(curve.angle_rad.size(), 0);
    for (std::size_t k = 0; k < curve.position_m.size(); ++k) {
      mean.position_m[k] += share * curve.position_m[k];
      mean.angle_rad[k] += share * curve.angle_rad[k];
    }
  }
}

}  // namespace

ConvergenceResult run_convergence(const std::vector<TruePlacement>& placements,
                                  const ConvergenceOptions& options) {
  std::vector<std::unique_ptr<Matcher>> matchers;
  for (const TruePlacement& p : placements)
    matchers.push_back(std::make_unique<Matcher>(p, options));
  const int trials = static_cast<int>(placements.size()) * options.starts;
  std::vector<ConvergenceCurve> bpa(static_cast<std::size_t>(trials)), icp(bpa.size());
  parallel_for(trials, options.num_threads, [&](int trial) {
    const auto t = static_cast<std::size_t>(trial);
    const auto p = static_cast<std::size_t>(trial / options.starts);
    RandomStream random(options.seed, t);
    const Pose start = disturb(placements[p].camera_from_object, options, random);
    bpa[t] = run_trial(placements[p], *matchers[p], start, Method::bpa, random, options.iterations);
    icp[t] = run_trial(placements[p], *matchers[p], start, Method::icp, random, options.iterations);
  });
  ConvergenceResult result;
  result.trials = trials;
  add_mean(bpa, result.bpa);
  add_mean(icp, result.icp);
  return result;
}

}  // namespace bpa::align
