// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <bpa/core/base/parallel.hpp>
#include <bpa/core/model/distance_transform.hpp>
#include <bpa/core/model/symmetry_search.hpp>

namespace bpa {
namespace {

constexpr double kTurn = 2 * M_PI;

// How well turned copies of a surface lie on it.
class SelfMatch {
 public:
  SelfMatch(const PointCloud& surface, float tolerance)
      : surface_(surface),
        tolerance_(tolerance),
        distances_(distance_transform(surface.points, 0.003f, 0.02f)) {
    mean_.setZero();
    for (const Eigen::Vector3f& p : surface.points) {
      mean_ += p.cast<double>() / static_cast<double>(surface.size());
    }
  }

  const Eigen::Vector3d& mean() const { return mean_; }

  struct Fit {
    double share = 0;  // of the points that lie on the surface after the turn
    double off = 0;    // how far these are from it on average, as a share of the tolerance
  };

  // Of about `count` points.
  Fit fit(const Eigen::Vector3d& axis, double angle, std::size_t count) const {
    const Eigen::Matrix3f r = Eigen::AngleAxisd(angle, axis).toRotationMatrix().cast<float>();
    const Eigen::Vector3f mean = mean_.cast<float>();
    const std::size_t stride = std::max<std::size_t>(1, surface_.size() / count);
    double on = 0, all = 0, off = 0;
    for (std::size_t i = 0; i < surface_.size(); i += stride) {
      ++all;
      const float distance =
          distance_to(r * (surface_.points[i] - mean) + mean, r * surface_.normals[i]);
      if (distance > tolerance_) continue;
      ++on;
      off += static_cast<double>(distance / tolerance_);
    }
    return {on / all, on > 0 ? off / on : 1};
  }
  double share(const Eigen::Vector3d& axis, double angle, std::size_t count) const {
    return fit(axis, angle, count).share;
  }

 private:
  // To the tangent plane of the surface near p that faces like n; large where there is none. In a
  // thin wall the point nearest to p may be of the other side: one step outside it is not.
  float distance_to(const Eigen::Vector3f& p, const Eigen::Vector3f& n) const {
    for (const float step : {0.0f, 0.003f}) {
      const int found = distances_.nearest_to(p + step * n);
      if (found < 0) continue;
      const auto j = static_cast<std::size_t>(found);
      const Eigen::Vector3f d = p - surface_.points[j];
      if (surface_.normals[j].dot(n) < 0.6f || d.norm() > 4 * tolerance_ + 0.004f) continue;
      return std::abs(d.dot(surface_.normals[j]));
    }
    return 1;
  }

  const PointCloud& surface_;
  float tolerance_;
  DistanceTransform distances_;
  Eigen::Vector3d mean_;
};

// Hill climbing over the direction of the axis, about which turns by all the angles must fit;
// returns the share of the points for which the worst of them does.
double climb(const SelfMatch& match, const std::vector<double>& angles, Eigen::Vector3d& axis) {
  constexpr std::size_t kPoints = 900;
  const auto score = [&](const Eigen::Vector3d& a) {
    double least = 1;
    for (const double angle : angles) {
      const SelfMatch::Fit fit = match.fit(a, angle, kPoints);
      least = std::min(least, fit.share - 0.1 * fit.off);
    }
    return least;
  };
  double best = score(axis);
  for (double step = 0.03; step > 0.002; step *= 0.5) {
    for (bool better = true; better;) {
      better = false;
      const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
      for (const Eigen::Vector3d& d : {u, v, Eigen::Vector3d(-u), Eigen::Vector3d(-v)}) {
        const Eigen::Vector3d next = (axis + step * d).normalized();
        const double s = score(next);
        if (s <= best + 1e-9) continue;
        best = s;
        axis = next;
        better = true;
        break;
      }
    }
  }
  double least = 1;
  for (const double angle : angles) least = std::min(least, match.share(axis, angle, kPoints));
  return least;
}

constexpr double kSymmetric = 0.98;  // share of the points

// Axes about which turns by all of the angles fit, no two within 8 degrees.
std::vector<Eigen::Vector3d> axes_of(const SelfMatch& match, const std::vector<double>& angles,
                                     int num_threads) {
  constexpr int kDirections = 900, kTried = 24;
  std::vector<std::pair<double, Eigen::Vector3d>> tried(kDirections);
  const double golden_angle = M_PI * (3 - std::sqrt(5.0));
  parallel_for(
      kDirections, num_threads,
      [&](int i) {
        const double z = 1 - (i + 0.5) / kDirections;  // half the sphere
        const double r = std::sqrt(1 - z * z);
        const Eigen::Vector3d axis(r * std::cos(golden_angle * i), r * std::sin(golden_angle * i),
                                   z);
        tried[static_cast<std::size_t>(i)] = {match.share(axis, angles.front(), 150), axis};
      },
      16);
  std::stable_sort(tried.begin(), tried.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto apart = [](const std::vector<Eigen::Vector3d>& axes, const Eigen::Vector3d& axis) {
    return std::none_of(axes.begin(), axes.end(),
                        [&](const auto& a) { return std::abs(a.dot(axis)) > std::cos(0.14); });
  };
  std::vector<Eigen::Vector3d> starts, axes;
  for (const auto& [share, axis] : tried) {
    if (static_cast<int>(starts.size()) >= kTried || share < 0.4) break;
    if (apart(starts, axis)) starts.push_back(axis);
  }
  std::vector<double> score(starts.size());
  parallel_for(static_cast<int>(starts.size()), num_threads, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    score[i] = climb(match, angles, starts[i]);
  });
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (score[i] >= kSymmetric && apart(axes, starts[i])) axes.push_back(starts[i]);
  }
  return axes;
}

Pose turn_about(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis));
  return {q, point - q * point};
}

// All products of the turns, without the identity.
std::vector<Pose> closed(std::vector<Pose> turns) {
  constexpr std::size_t kMost = 60;  // rotations of the icosahedron
  constexpr double kSame = 0.12;     // radians
  std::vector<Pose> group;
  const auto add = [&](const Pose& pose) {
    if (rotation_angle(pose.rotation, Eigen::Quaterniond::Identity()) < kSame) return;
    const bool known = std::any_of(group.begin(), group.end(), [&](const Pose& g) {
      return rotation_angle(g.rotation, pose.rotation) < kSame;
    });
    if (!known && group.size() < kMost) group.push_back(pose);
  };
  for (const Pose& turn : turns) add(turn);
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      add(group[i] * group[j]);
      add(group[j] * group[i]);
    }
  }
  return group;
}

// An axis as people would write it.
Eigen::Vector3d upright(Eigen::Vector3d axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace

SymmetryGroup find_symmetries(const PointCloud& surface, double diameter, int num_threads) {
  SymmetryGroup group;
  if (surface.size() < 100) return group;
  const SelfMatch match(surface, static_cast<float>(std::max(0.0015, 0.012 * diameter)));
  // Turns that no discrete symmetry has together.
  const std::vector<double> any{kTurn * 0.381, kTurn * 0.107, kTurn * 0.23, kTurn * 0.5};
  for (const Eigen::Vector3d& axis : axes_of(match, any, num_threads)) {
    group.continuous.push_back({upright(axis), match.mean()});
  }
  if (!group.continuous.empty()) {
    const Eigen::Vector3d across = group.continuous.front().axis.unitOrthogonal();
    if (group.continuous.size() == 1 && match.share(across, M_PI, 2000) >= kSymmetric) {
      group.discrete.push_back(turn_about(match.mean(), across, M_PI));
    }
    return group;
  }
  std::vector<Pose> turns;
  for (int order = 6; order >= 2; --order) {
    for (const Eigen::Vector3d& axis : axes_of(match, {kTurn / order}, num_threads)) {
      turns.push_back(turn_about(match.mean(), upright(axis), kTurn / order));
    }
  }
  group.discrete = closed(std::move(turns));
  return group;
}

std::string describe(const SymmetryGroup& group) {
  if (group.trivial()) return "none";
  std::string text;
  char line[160];
  for (const ContinuousSymmetry& c : group.continuous) {
    const Eigen::Vector3d p = 1000 * (c.point - c.axis * c.axis.dot(c.point));
    std::snprintf(
        line, sizeof line, "%sany turn about (%.2f, %.2f, %.2f) through (%.1f, %.1f, %.1f) mm",
        text.empty() ? "" : "; ", c.axis.x(), c.axis.y(), c.axis.z(), p.x(), p.y(), p.z());
    text += line;
  }
  for (const Pose& pose : group.discrete) {
    const Eigen::Vector3d v = vector_from_rotation(pose.rotation);
    const Eigen::Vector3d axis = upright(v.normalized());
    std::snprintf(line, sizeof line, "%s%.0f degrees about (%.2f, %.2f, %.2f)",
                  text.empty() ? "" : "; ", v.norm() * 180 / M_PI, axis.x(), axis.y(), axis.z());
    text += line;
  }
  return text;
}

}  // namespace bpa
