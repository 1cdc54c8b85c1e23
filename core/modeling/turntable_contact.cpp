// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// An object stands on its table in every resting position. What one scan shows of the face that the
// object stands on in the other one must lie on that one's table: of a can upside down, nothing
// else says how far it is from one end to the other, since its side slides along itself.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/fast_pose.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa {
namespace {

constexpr float kReach = 0.005f;  // metres: what counts as the same surface

// How high above its table the face that the object stands on is, by points of another scan that
// are moved there; nothing where they do not show such a face.
std::optional<double> standing_height(const PointCloud& points, const Pose& table_from_points) {
  constexpr double kDown = -0.9, kThickness = 0.003, kHighest = 0.015;
  std::vector<double> heights;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d n = table_from_points.rotation * points.normals[i].cast<double>();
    if (n.z() > kDown) continue;
    heights.push_back((table_from_points * points.points[i].cast<double>()).z());
  }
  const std::size_t fewest = std::max<std::size_t>(20, points.size() / 50);
  if (heights.size() < fewest) return std::nullopt;
  // It may be hollow in the middle: its lowest tenth is what it stands on.
  const auto tenth = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 10);
  std::nth_element(heights.begin(), tenth, heights.end());
  const double height = *tenth;
  const auto face = std::count_if(heights.begin(), heights.end(),
                                  [&](double h) { return std::abs(h - height) < kThickness; });
  if (static_cast<std::size_t>(face) < fewest || std::abs(height) > kHighest) return std::nullopt;
  return height;
}

// Sums of a least-squares problem for a shift of the source.
struct ShiftSums {
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double squares = 0, count = 0;

  // A shift by `off` along `direction` is what is wanted.
  void add(const Eigen::Vector3d& direction, double off, double weight) {
    hessian += weight * direction * direction.transpose();
    gradient += weight * off * direction;
  }
  double rms() const { return count > 0 ? std::sqrt(squares / count) : 0; }
};

// Point to plane, over the points of the source that lie on the target, facing the same way.
ShiftSums overlap_sums(const PointCloud& source, const PointCloud& target, const NeighborGrid& near,
                       const Pose& pose) {
  constexpr float kSameSide = 0.7f;  // cosine between normals
  ShiftSums sums;
  const FastPose fast = to_fast(pose);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f p = fast * source.points[i];
    const Eigen::Vector3f n = fast.rotation * source.normals[i];
    float best = kReach * kReach;
    int found = -1;
    near.for_each_neighbor(p, [&](int j, float squared) {
      const float cosine = n.dot(target.normals[static_cast<std::size_t>(j)]);
      if (cosine < kSameSide || squared > best) return;
      best = squared;
      found = j;
    });
    if (found < 0) continue;
    const auto j = static_cast<std::size_t>(found);
    const auto off = static_cast<double>(target.normals[j].dot(target.points[j] - p));
    sums.add(target.normals[j].cast<double>(), off, 1);
    sums.squares += off * off;
    ++sums.count;
  }
  return sums;
}

}  // namespace

Pose settle_on_tables(const PointCloud& source, const PointCloud& target,
                      const Pose& target_from_source) {
  constexpr int kRounds = 10;
  constexpr double kWeight = 0.2;      // of a table beside the overlap
  constexpr double kMostWorse = 3e-4;  // what the overlap may lose, metres
  const NeighborGrid near(target.points, kReach);
  Pose pose = target_from_source;
  double before = 0;
  for (int round = 0; round <= kRounds; ++round) {
    ShiftSums sums = overlap_sums(source, target, near, pose);
    if (round == 0) before = sums.rms();
    if (sums.count < 12 || sums.rms() > before + kMostWorse) return target_from_source;
    if (round == kRounds) break;
    const std::optional<double> there = standing_height(source, pose);
    const std::optional<double> back = standing_height(target, pose.inverse());
    if (!there && !back) break;
    const double weight = kWeight * sums.count;
    if (there) sums.add(Eigen::Vector3d::UnitZ(), -*there, weight);
    if (back) sums.add(pose.rotation * Eigen::Vector3d::UnitZ(), *back, weight);
    sums.hessian += 1e-3 * sums.count * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d shift = sums.hessian.ldlt().solve(sums.gradient);
    pose.translation += shift;
    if (shift.norm() < 1e-5) break;
  }
  return pose;
}

}  // namespace bpa
