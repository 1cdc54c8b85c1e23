// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/near_symmetry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/geometry/pose.hpp"
#include "core/geometry/solve_symmetric.hpp"

namespace bpa {
namespace {

constexpr int kSteps = 24;  // of a full turn
constexpr std::size_t kMostMotions = 40;
constexpr double kShare = 0.6;      // of the points that have to lie on the surface
constexpr double kHopeless = 0.35;  // the same before the motion is moved to its best fit
constexpr float kFacing = 0.7f;     // cosine
constexpr double kSameMotionAngle = 10 * M_PI / 180;  // radians
constexpr double kSameMotionDistance = 0.01;          // metres

class SelfFit {
 public:
  explicit SelfFit(const SelfSurface& surface) : surface_(surface) {
    for (const std::uint32_t i : surface.sample) {
      centre_ += surface.points[i].cast<double>() / static_cast<double>(surface.sample.size());
    }
  }

  const Eigen::Vector3d& centre() const { return centre_; }

  Eigen::Matrix3d principal_axes() const {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : surface_.sample) {
      const Eigen::Vector3d d = surface_.points[i].cast<double>() - centre_;
      moments += d * d.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
  }

  // The share of the sample that lies on the surface after the motion.
  double share(const Pose& motion, double tolerance) const {
    int on = 0;
    for_each_match(motion, tolerance, [&](const auto&, const auto&, double) { ++on; });
    return static_cast<double>(on) / static_cast<double>(surface_.sample.size());
  }

  // Point-to-plane steps with a closing gate, about the centre.
  Pose fitted(Pose motion) const {
    for (double gate = 0.10; gate > 0.03; gate *= 0.75) {
      Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
      for_each_match(motion, gate * surface_.diameter,
                     [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double off) {
                       Eigen::Matrix<double, 6, 1> row;
                       row << normal, (p - centre_).cross(normal);
                       information += row * row.transpose();
                       gradient += off * row;
                     });
      // What no point holds (a turn about the axis of a cylinder) does not move.
      const double places = 1e-3 * static_cast<double>(surface_.sample.size());
      const double lever = 0.25 * surface_.diameter * surface_.diameter;
      information.diagonal().head<3>().array() += places;
      information.diagonal().tail<3>().array() += places * lever;
      const Eigen::Matrix<double, 6, 1> step = -solve_symmetric(information, gradient);
      const Eigen::Quaterniond turn = rotation_from_vector(step.tail<3>());
      motion = Pose{turn, step.head<3>() + centre_ - turn * centre_} * motion;
      motion.rotation.normalize();
    }
    return motion;
  }

 private:
  // Calls visit(point, normal of the surface there, how far off its plane) for each point of the
  // sample that the motion brings within `gate` metres of the surface.
  void for_each_match(const Pose& motion, double gate, const auto& visit) const {
    const FastPose fast = to_fast(motion);
    for (const std::uint32_t i : surface_.sample) {
      const Eigen::Vector3f p = fast * surface_.points[i];
      const Eigen::Vector3f n = fast.rotation * surface_.normals[i];
      const int j = nearest(p, n);
      if (j < 0) continue;
      const Eigen::Vector3f d = p - surface_.points[j];
      const double off = d.dot(surface_.normals[j]), reach = 2 * gate + surface_.distances.cell;
      if (std::abs(off) > gate || d.norm() > reach) continue;
      visit(p.cast<double>(), surface_.normals[j].cast<double>(), off);
    }
  }

  // In a thin wall the point nearest to p may be of the other side: one step outside it is not.
  int nearest(const Eigen::Vector3f& p, const Eigen::Vector3f& n) const {
    for (const float step : {0.0f, 0.004f}) {
      const int found = surface_.distances.nearest_to(p + step * n);
      if (found >= 0 && surface_.normals[found].dot(n) > kFacing) return found;
    }
    return -1;
  }

  const SelfSurface& surface_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<Pose> near_symmetries(const SelfSurface& surface, const SymmetryGroup& exact) {
  if (surface.sample.empty()) return {};
  const SelfFit fit(surface);
  std::vector<Eigen::Vector3d> axes;
  const Eigen::Matrix3d principal = fit.principal_axes();
  for (int k = 0; k < 3; ++k) {
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(principal.col(k)), Eigen::Vector3d(Eigen::Vector3d::Unit(k))}) {
      const auto alike = [&](const auto& a) { return std::abs(a.dot(axis)) > std::cos(0.05); };
      if (std::ranges::none_of(axes, alike)) axes.push_back(axis);
    }
  }
  const double tolerance = 0.03 * surface.diameter;
  const auto same = [&](const Pose& a, const Pose& b) {
    const PoseError error = pose_error(a, b, exact, kSameMotionDistance, kSameMotionAngle);
    return error.position < kSameMotionDistance && error.angle < kSameMotionAngle;
  };
  std::vector<std::pair<double, Pose>> found;
  for (const Eigen::Vector3d& axis : axes) {
    for (int k = 1; k < kSteps; ++k) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(2 * M_PI * k / kSteps, axis));
      const Pose start{turn, fit.centre() - turn * fit.centre()};
      if (same(start, Pose()) || fit.share(start, 2 * tolerance) < kHopeless) continue;
      const Pose motion = fit.fitted(start);
      const double share = fit.share(motion, tolerance);
      if (share >= kShare && !same(motion, Pose())) found.push_back({share, motion});
    }
  }
  std::ranges::stable_sort(found, std::greater(), &std::pair<double, Pose>::first);
  std::vector<Pose> out;
  for (const auto& entry : found) {
    const Pose& motion = entry.second;
    const auto alike = [&](const Pose& other) { return same(motion, other); };
    if (std::ranges::none_of(out, alike)) out.push_back(motion);
    if (out.size() == kMostMotions) break;
  }
  return out;
}

}  // namespace bpa
