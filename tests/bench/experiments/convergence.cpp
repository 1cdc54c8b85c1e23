// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/experiments/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/align/align.hpp"
#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/pose.hpp"

namespace bpa::cli {
namespace {

using align::OrientedPair;

constexpr std::size_t kMinMatches = 3;  // With fewer a step leaves the pose as it is.

// Finds correspondences of one placement.
class Matcher {
 public:
  Matcher(const TruePlacement& placement, const ConvergenceOptions& options)
      : placement_(placement),
        model_(*placement.model),
        scene_(*placement.scene),
        options_(options),
        model_grid_(placement.model->points, static_cast<float>(options.gate_m)),
        fit_grid_(placement.model->points, static_cast<float>(options.assign_m)),
        fitting_cosine_(static_cast<float>(std::cos(options.assign_deg * M_PI / 180))) {
    // Only what any start may reach.
    for (const Eigen::Vector3f& p : model_.points) radius_ = std::max(radius_, p.norm());
    const double reach = radius_ + options.gate_m + 4 * options.start_position_m;
    PointCloud near;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      const Eigen::Vector3d p = scene_.points[i].cast<double>();
      if ((p - placement.camera_from_object.translation).norm() < reach &&
          scene_.normals[i].squaredNorm() > 0.5f) {
        near.points.push_back(scene_.points[i]);
        near.normals.push_back(scene_.normals[i]);
        indices.push_back(i);
      }
    }
    make_patches(near, indices);
  }

  const TruePlacement& placement() const { return placement_; }

  void find(const Pose& pose, bool curvature, RandomStream& random,
            std::vector<OrientedPair>& matches) const {
    const FastPose object_from_camera = to_fast(pose.inverse());
    std::vector<std::size_t> assigned;
    for (const std::vector<std::size_t>& patch : patches_) {
      const int size = static_cast<int>(patch.size());
      int fitting = 0;
      for (int k = 0; k < kFitSamples; ++k) {
        fitting += fits(object_from_camera, patch[random.index(size)]);
      }
      if (random.uniform() * kFitSamples < fitting) {
        assigned.insert(assigned.end(), patch.begin(), patch.end());
      }
    }
    if (assigned.empty()) return;
    for (int tries = 0; tries < 4 * options_.points; ++tries) {
      const std::size_t i = assigned[random.index(static_cast<int>(assigned.size()))];
      const Eigen::Vector3f p = object_from_camera * scene_.points[i];
      const Eigen::Vector3f n = object_from_camera.rotation * scene_.normals[i];
      const int nearest = nearest_model_point(model_grid_, p, n);
      if (nearest < 0) continue;
      matches.push_back({align::oriented_point(model_, nearest, curvature),
                         align::oriented_point(scene_, i, curvature), options_.sigma_m});
      if (std::ssize(matches) == options_.points) break;
    }
  }

 private:
  static constexpr int kFitSamples = 4;

  // Every point goes to the nearest patch centre that faces the same way.
  void make_patches(const PointCloud& near, const std::vector<std::size_t>& indices) {
    const auto size = static_cast<float>(options_.patch_m);
    const PointCloud centres = downsample(near, size);
    const NeighborGrid grid(centres.points, size);
    patches_.resize(centres.size());
    for (std::size_t k = 0; k < near.size(); ++k) {
      int nearest = -1;
      float least = INFINITY;
      grid.for_each_neighbor(near.points[k], [&](int c, float squared) {
        const float facing = centres.normals[c].dot(near.normals[k]);
        const float cost = squared / (size * size) + 2 * (1 - facing);
        if (cost < least) {
          least = cost;
          nearest = c;
        }
      });
      if (nearest >= 0) patches_[nearest].push_back(indices[k]);
    }
    std::erase_if(patches_, [](const std::vector<std::size_t>& p) { return p.size() < 3; });
  }

  // The nearest model point that does not face away, or -1.
  int nearest_model_point(const NeighborGrid& grid, const Eigen::Vector3f& p,
                          const Eigen::Vector3f& n) const {
    int nearest = -1;
    float least = INFINITY;
    grid.for_each_neighbor(p, [&](int index, float squared) {
      if (squared < least && model_.normals[index].dot(n) > 0) {
        least = squared;
        nearest = index;
      }
    });
    return nearest;
  }

  bool fits(const FastPose& object_from_camera, std::size_t i) const {
    const Eigen::Vector3f p = object_from_camera * scene_.points[i];
    if (p.norm() > radius_ + static_cast<float>(options_.assign_m)) return false;
    const Eigen::Vector3f n = object_from_camera.rotation * scene_.normals[i];
    const int nearest = nearest_model_point(fit_grid_, p, n);
    return nearest >= 0 && model_.normals[nearest].dot(n) > fitting_cosine_;
  }

  const TruePlacement& placement_;
  const PointCloud& model_;
  const PointCloud& scene_;
  const ConvergenceOptions& options_;
  NeighborGrid model_grid_;
  NeighborGrid fit_grid_;
  float fitting_cosine_;
  float radius_ = 0;                               // Of the model about its origin.
  std::vector<std::vector<std::size_t>> patches_;  // Scene points by index.
};

Pose disturb(const Pose& truth, const ConvergenceOptions& options, RandomStream& random) {
  Eigen::Vector3d move, turn;
  for (int i = 0; i < 3; ++i) move[i] = options.start_position_m * random.normal();
  for (int i = 0; i < 3; ++i) turn[i] = options.start_angle_deg * M_PI / 180 * random.normal();
  return {(rotation_from_vector(turn) * truth.rotation).normalized(), truth.translation + move};
}

// The alignment between two matchings.
using Method = align::PoseEstimate (*)(const align::Correspondences&);

// The least errors so far, after each step of one trial.
ConvergenceCurve run_trial(const Matcher& matcher, Pose pose, Method align, bool curvature,
                           RandomStream random, int iterations) {
  const TruePlacement& placement = matcher.placement();
  ConvergenceCurve curve;
  double position = INFINITY, angle = INFINITY;
  const auto record = [&] {
    const PoseError error = pose_error(pose, placement.camera_from_object, placement.symmetry);
    position = std::min(position, error.position);
    angle = std::min(angle, error.angle);
    curve.position_m.push_back(position);
    curve.angle_rad.push_back(angle);
  };
  record();
  std::vector<OrientedPair> matches;
  for (int step = 0; step < iterations; ++step) {
    matches.clear();
    matcher.find(pose, curvature, random, matches);
    if (matches.size() >= kMinMatches) pose = align({.oriented = matches}).camera_from_object;
    record();
  }
  return curve;
}

void add(const ConvergenceCurve& curve, double share, ConvergenceCurve& mean) {
  mean.position_m.resize(curve.position_m.size(), 0);
  mean.angle_rad.resize(curve.angle_rad.size(), 0);
  for (std::size_t k = 0; k < curve.position_m.size(); ++k) {
    mean.position_m[k] += share * curve.position_m[k];
    mean.angle_rad[k] += share * curve.angle_rad[k];
  }
}

}  // namespace

ConvergenceResult run_convergence(const std::vector<TruePlacement>& placements,
                                  const ConvergenceOptions& options) {
  std::vector<std::unique_ptr<Matcher>> matchers;
  for (const TruePlacement& p : placements)
    matchers.push_back(std::make_unique<Matcher>(p, options));
  const int trials = static_cast<int>(placements.size()) * options.starts;
  std::vector<ConvergenceResult> results(trials);
  parallel_for(trials, options.num_threads, [&](int trial) {
    const int p = trial / options.starts;
    RandomStream random(options.seed, static_cast<std::uint64_t>(trial));
    const Pose start = disturb(placements[p].camera_from_object, options, random);
    const auto run = [&](Method method, bool curvature) {
      return run_trial(*matchers[p], start, method, curvature, random, options.iterations);
    };
    results[trial] = {run(align::bpa_mode, true), run(align::bpa_mode, false),
                      run(align::icp_mode, false), 1};
  });
  ConvergenceResult mean{.trials = trials};
  for (const ConvergenceResult& result : results) {
    add(result.bpa, 1.0 / trials, mean.bpa);
    add(result.bpa_normals, 1.0 / trials, mean.bpa_normals);
    add(result.icp, 1.0 / trials, mean.icp);
  }
  return mean;
}

}  // namespace bpa::cli
