// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/surface_alignment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/median.hpp"

namespace bpa::calibration {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kLeastCosine = 0.7;     // of matched normals: 45 degrees. Chosen by hand
constexpr double kSurfaceSigma = 0.001;  // metres, beside the sensors' noise. Chosen by hand
constexpr double kCorrelated = 12;       // depth errors of neighbouring pixels go together

// Points of one view, spread over its image.
struct Sampled {
  std::vector<Eigen::Vector3d> points, normals;  // camera frame
};

Sampled sampled(const SurfaceMap& map, int max_points) {
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.depth[i] > 0 && map.normals[i].squaredNorm() > 0) valid.push_back(i);
  }
  Sampled out;
  const std::size_t count = std::min<std::size_t>(valid.size(), max_points);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = valid[k * valid.size() / count];
    out.points.push_back(map.points[i].cast<double>());
    out.normals.push_back(map.normals[i].cast<double>());
  }
  return out;
}

// A point of one view on the surface of another, scene frame.
struct Match {
  Eigen::Vector3d point, normal;
  double distance = 0;  // of the point from the other's tangent plane, metres
  double sigma = 0;     // its standard deviation, metres
};

class Aligner {
 public:
  Aligner(std::span<const PosedSurface> views, const SurfaceAlignmentOptions& options)
      : views_(views), options_(options) {
    for (const PosedSurface& view : views)
      samples_.push_back(sampled(*view.map, options.max_points));
  }

  // Points of view a on the surface of view b.
  std::vector<Match> matches(int a, int b, const Pose& scene_from_a, const Pose& scene_from_b,
                             double gate) const {
    std::vector<Match> out;
    const SurfaceMap& map = *views_[b].map;
    const Pose b_from_a = scene_from_b.inverse() * scene_from_a;
    const Eigen::Matrix3d turn = b_from_a.matrix();
    const Sampled& from = samples_[a];
    for (std::size_t k = 0; k < from.points.size(); ++k) {
      const Eigen::Vector3d point = turn * from.points[k] + b_from_a.translation;
      if (!(point.z() > 0)) continue;
      const Eigen::Vector2d at = map.camera.project(point);
      const int u = static_cast<int>(std::lround(std::clamp(at.x(), -2.0, 1e6)));
      const int v = static_cast<int>(std::lround(std::clamp(at.y(), -2.0, 1e6)));
      if (u < 0 || v < 0 || u >= map.width() || v >= map.height()) continue;
      const auto i = static_cast<std::size_t>(v * map.width() + u);
      if (!(map.depth[i] > 0) || map.normals[i].squaredNorm() == 0) continue;
      const Eigen::Vector3d normal = map.normals[i].cast<double>();
      if (normal.dot(turn * from.normals[k]) < kLeastCosine) continue;
      const double distance = normal.dot(point - map.points[i].cast<double>());
      if (std::abs(distance) > gate) continue;
      const double noise_a = views_[a].map->noise(static_cast<float>(from.points[k].z()));
      const double noise_b = map.noise(map.depth[i]);
      out.push_back({scene_from_b * point, scene_from_b.rotation * normal, distance,
                     std::hypot(noise_a, noise_b, kSurfaceSigma)});
    }
    return out;
  }

  // Moves the cameras of `moving` views; the others stay.
  void align(std::vector<Pose>& poses, const std::vector<int>& among,
             const std::vector<bool>& moving) const {
    const std::vector<Pose> start = poses;
    for (int step = 0; step < options_.iterations; ++step) {
      const double part = step / std::max(1.0, options_.iterations - 1.0);
      const double gate =
          options_.start_gate_m + part * (options_.end_gate_m - options_.start_gate_m);
      if (!step_once(poses, start, among, moving, gate)) return;
    }
  }

 private:
  bool step_once(std::vector<Pose>& poses, const std::vector<Pose>& start,
                 const std::vector<int>& among, const std::vector<bool>& moving,
                 double gate) const {
    const auto size = static_cast<Eigen::Index>(6 * views_.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (const int a : among) {
      for (const int b : among) {
        if (a == b) continue;
        const auto found = matches(a, b, poses[a], poses[b], gate);
        if (static_cast<int>(found.size()) * 2 < options_.min_matches) continue;
        for (const Match& match : found) add(match, a, b, gate, poses, information, gradient);
      }
    }
    for (const int v : among) add_prior(v, poses[v], start[v], information, gradient);
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const bool stays = !moving[v] || std::ranges::count(among, static_cast<int>(v)) == 0;
      if (!stays) continue;
      const auto at = static_cast<Eigen::Index>(6 * v);
      information.middleRows<6>(at).setZero();
      information.middleCols<6>(at).setZero();
      information.block<6, 6>(at, at).setIdentity();
      gradient.segment<6>(at).setZero();
    }
    const Eigen::VectorXd step = -information.ldlt().solve(gradient);
    if (!step.allFinite()) return false;
    for (const int v : among) {
      const Vector6 own = step.segment<6>(6 * v);
      poses[v].translation += own.head<3>();
      poses[v].rotation = (rotation_from_vector(own.tail<3>()) * poses[v].rotation).normalized();
    }
    return true;
  }

  // Unknowns of a camera: its translation, then its rotation about its own centre; scene axes.
  void add(const Match& match, int a, int b, double gate, const std::vector<Pose>& poses,
           Eigen::MatrixXd& information, Eigen::VectorXd& gradient) const {
    const double ratio = match.distance / gate;
    const double robust = 1 - ratio * ratio;
    const double weight = robust * robust / (match.sigma * match.sigma * kCorrelated);
    Vector6 of_a, of_b;
    of_a << match.normal, (match.point - poses[a].translation).cross(match.normal);
    of_b << -match.normal, -(match.point - poses[b].translation).cross(match.normal);
    const Eigen::Index at_a = 6 * a, at_b = 6 * b;
    information.block<6, 6>(at_a, at_a) += weight * of_a * of_a.transpose();
    information.block<6, 6>(at_b, at_b) += weight * of_b * of_b.transpose();
    information.block<6, 6>(at_a, at_b) += weight * of_a * of_b.transpose();
    information.block<6, 6>(at_b, at_a) += weight * of_b * of_a.transpose();
    gradient.segment<6>(at_a) += weight * match.distance * of_a;
    gradient.segment<6>(at_b) += weight * match.distance * of_b;
  }

  void add_prior(int view, const Pose& pose, const Pose& start, Eigen::MatrixXd& information,
                 Eigen::VectorXd& gradient) const {
    const double angle_sigma = options_.angle_sigma_deg * std::numbers::pi / 180;
    Vector6 weights, error;
    weights.head<3>().setConstant(1 / (options_.position_sigma_m * options_.position_sigma_m));
    weights.tail<3>().setConstant(1 / (angle_sigma * angle_sigma));
    error << pose.translation - start.translation,
        vector_from_rotation(pose.rotation * start.rotation.conjugate());
    const Eigen::Index at = 6 * view;
    information.block<6, 6>(at, at) += Matrix6(weights.asDiagonal());
    gradient.segment<6>(at) += weights.cwiseProduct(error);
  }

  std::span<const PosedSurface> views_;
  const SurfaceAlignmentOptions& options_;
  std::vector<Sampled> samples_;
};

double median_distance(const std::vector<Match>& matches) {
  std::vector<double> distances;
  for (const Match& match : matches) distances.push_back(std::abs(match.distance));
  return median(distances);
}

std::vector<Match> both_ways(const Aligner& aligner, int a, int b, const std::vector<Pose>& poses,
                             double gate) {
  std::vector<Match> out = aligner.matches(a, b, poses[a], poses[b], gate);
  for (const Match& match : aligner.matches(b, a, poses[b], poses[a], gate)) out.push_back(match);
  return out;
}

}  // namespace

SurfaceAlignment align_surfaces(std::span<const PosedSurface> views,
                                const SurfaceAlignmentOptions& options) {
  const Aligner aligner(views, options);
  SurfaceAlignment out;
  std::vector<int> all;
  for (const PosedSurface& view : views) {
    all.push_back(static_cast<int>(all.size()));
    out.scene_from_camera.push_back(view.scene_from_camera);
  }
  const std::vector<Pose> start = out.scene_from_camera;
  const std::vector<bool> moving(views.size(), true);
  aligner.align(out.scene_from_camera, all, moving);
  for (const int b : all) {
    for (int a = 0; a < b; ++a) {
      const auto before = both_ways(aligner, a, b, start, options.start_gate_m);
      std::vector<bool> second(views.size(), false);
      second[b] = true;
      std::vector<Pose> poses = start;
      aligner.align(poses, {a, b}, second);
      const auto after = both_ways(aligner, a, b, poses, options.start_gate_m);
      const int common = static_cast<int>(std::min(before.size(), after.size()));
      if (common < options.min_matches) continue;
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const Match& match : after) middle += match.point / static_cast<double>(after.size());
      const Pose motion = poses[b] * start[b].inverse();
      out.pairs.push_back({a, b, static_cast<int>(after.size()), median_distance(before),
                           median_distance(after), (middle - motion.inverse() * middle).norm(),
                           rotation_angle(motion.rotation, Eigen::Quaterniond::Identity())});
    }
  }
  return out;
}

std::string disagreement_text(const SurfaceDisagreement& pair, const std::string& first,
                              const std::string& second) {
  std::array<char, 256> numbers{};
  std::snprintf(numbers.data(), numbers.size(),
                "disagree by %.1f mm and %.2f degrees: moving one so reduces the median distance "
                "of their surfaces from %.1f to %.1f mm",
                1000 * pair.position_m, pair.angle_rad * 180 / std::numbers::pi,
                1000 * pair.residual_m, 1000 * pair.aligned_m);
  return "cameras \"" + first + "\" and \"" + second + "\" " + numbers.data();
}

}  // namespace bpa::calibration
