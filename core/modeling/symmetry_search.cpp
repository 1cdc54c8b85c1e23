// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/symmetry_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include <opencv2/core.hpp>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/model/distance_transform.hpp"
#include "core/model/object_model.hpp"

namespace bpa::modeling {
namespace {

constexpr double kTurn = 2 * M_PI;
constexpr float kSameSide = 0.6f;    // cosine between normals
constexpr double kSymmetric = 0.98;  // share of the points
constexpr double kPromising = 0.85;  // the same by a quick look
constexpr double kNearly = 0.95;     // the same where other turns have shown half of it already

// Angles that no discrete symmetry has together.
const std::vector<double> kAnyTurns{kTurn * 0.381, kTurn * 0.107, kTurn * 0.23, kTurn * 0.5};

struct Axis {
  Eigen::Vector3d direction, point;
};

// How well turned copies of a surface lie on it.
class SelfMatch {
 public:
  SelfMatch(const PointCloud& surface, float tolerance)
      : surface_(surface),
        tolerance_(tolerance),
        distances_(distance_transform(surface.points, 0.003f, 0.02f)),
        // No point of an evenly sampled surface is farther from the samples.
        neighbors_(surface.points, tolerance + 2 * mean_spacing(surface, kSameSide)) {
    for (const Eigen::Vector3f& p : surface.points) mean_ += p.cast<double>() / surface.size();
    for (const Eigen::Vector3f& p : surface.points) {
      radius_ = std::max(radius_, (p.cast<double>() - mean_).norm());
    }
  }

  const Eigen::Vector3d& mean() const { return mean_; }
  double radius() const { return radius_; }  // of the surface about the mean

  struct Fit {
    double share = 0;  // of the points that lie on the surface after the turn
    double off = 0;    // how far these are from it on average, as a share of the tolerance
  };

  // Of about `count` points, by the distance transform: quick, but a point that lies in the plane
  // of the surface a little beyond its rim counts as on it.
  Fit fit(const Axis& axis, double angle, std::size_t count) const {
    double on = 0, all = 0, off = 0;
    for_each_turned(axis, angle, count, [&](const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
      ++all;
      const float distance = distance_to(p, n);
      if (distance > tolerance_) return;
      ++on;
      off += distance / tolerance_;
    });
    return {on / all, on > 0 ? off / on : 1};
  }
  double share(const Axis& axis, double angle, std::size_t count) const {
    return fit(axis, angle, count).share;
  }

  // The share by exact neighbours: beyond the rim is off the surface.
  double exact_share(const Axis& axis, double angle) const {
    double on = 0, all = 0;
    for_each_turned(axis, angle, 3000, [&](const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
      ++all;
      bool found = false;
      neighbors_.for_each_neighbor(p, [&](int j, float) {
        const Eigen::Vector3f& normal = surface_.normals[j];
        found = found || (normal.dot(n) > kSameSide &&
                          std::abs(normal.dot(p - surface_.points[j])) < tolerance_);
      });
      on += found ? 1 : 0;
    });
    return on / all;
  }

 private:
  template <class Visit>
  void for_each_turned(const Axis& axis, double angle, std::size_t count,
                       const Visit& visit) const {
    const Eigen::Matrix3f r =
        Eigen::AngleAxisd(angle, axis.direction).toRotationMatrix().cast<float>();
    const Eigen::Vector3f point = axis.point.cast<float>();
    const std::size_t stride = std::max<std::size_t>(1, surface_.size() / count);
    for (std::size_t i = 0; i < surface_.size(); i += stride) {
      visit(Eigen::Vector3f(r * (surface_.points[i] - point) + point),
            Eigen::Vector3f(r * surface_.normals[i]));
    }
  }

  // To the tangent plane of the surface near p that faces like n; large where there is none. In a
  // wall with thickness, the point nearest to p may be of the other side, but not one step outside.
  float distance_to(const Eigen::Vector3f& p, const Eigen::Vector3f& n) const {
    float other_side = 1;
    for (const float step : {0.0f, 0.003f}) {
      const int found = distances_.nearest_to(p + step * n);
      if (found < 0) continue;
      const Eigen::Vector3f d = p - surface_.points[found];
      const float cosine = surface_.normals[found].dot(n);
      if (std::abs(cosine) < kSameSide || d.norm() > 4 * tolerance_ + 0.004f) continue;
      const float off = std::abs(d.dot(surface_.normals[found]));
      if (cosine > 0) return off;
      other_side = std::min(other_side, off);
    }
    return other_side;
  }

  const PointCloud& surface_;
  float tolerance_;
  DistanceTransform distances_;
  NeighborGrid neighbors_;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

// Hill climbing over direction and place of the axis, about which turns by all the angles must fit;
// returns the share of the points for which the worst of them does. The axis starts at the mean of
// the points, which parts that a scan has missed have moved.
double climb(const SelfMatch& match, const std::vector<double>& angles, Axis& axis) {
  constexpr std::size_t kPoints = 900;
  constexpr int kMostSteps = 12;  // of one size
  const auto score = [&](const Axis& a) {
    double least = 1;
    for (const double angle : angles) {
      const SelfMatch::Fit fit = match.fit(a, angle, kPoints);
      least = std::min(least, fit.share - 0.1 * fit.off);
    }
    return least;
  };
  double best = score(axis);
  // Takes the first of eight small moves that is better.
  const auto improve = [&](double step) {
    const Eigen::Vector3d u = axis.direction.unitOrthogonal(), v = axis.direction.cross(u);
    for (const Eigen::Vector3d& d : {u, v, Eigen::Vector3d(-u), Eigen::Vector3d(-v)}) {
      const Axis turned{(axis.direction + step * d).normalized(), axis.point};
      const Axis moved{axis.direction, axis.point + step * match.radius() * d};
      for (const Axis& next : {turned, moved}) {
        const double s = score(next);
        if (s <= best + 1e-9) continue;
        best = s;
        axis = next;
        return true;
      }
    }
    return false;
  };
  for (double step = 0.03; step > 0.002; step *= 0.5) {
    for (int k = 0; k < kMostSteps && improve(step); ++k) continue;
  }
  double least = 1;
  for (const double angle : angles) least = std::min(least, match.share(axis, angle, kPoints));
  return least;
}

// The worst of the angles, by exact neighbours, or what is not enough anyway.
double worst_share(const SelfMatch& match, const Axis& axis, const std::vector<double>& angles) {
  double least = 1;
  for (const double angle : angles) {
    if (least < kNearly) break;
    least = std::min(least, match.exact_share(axis, angle));
  }
  return least;
}

// Axes about which turns by all of the angles fit, no two within 8 degrees.
std::vector<Axis> axes_of(const SelfMatch& match, const std::vector<double>& angles,
                          int num_threads) {
  constexpr int kDirections = 900, kTried = 24;
  std::vector<std::pair<double, Axis>> tried(kDirections);
  parallel_for(kDirections, num_threads, [&](int i) {
    const Axis axis{sphere_direction(i, 2 * kDirections), match.mean()};  // half the sphere
    tried[i] = {match.share(axis, angles.front(), 150), axis};
  });
  std::ranges::stable_sort(tried, std::greater(), &std::pair<double, Axis>::first);
  const auto apart = [](const std::vector<Axis>& axes, const Axis& axis) {
    return std::ranges::none_of(axes, [&](const Axis& a) {
      return std::abs(a.direction.dot(axis.direction)) > std::cos(0.14);
    });
  };
  std::vector<Axis> starts, axes;
  for (const auto& [share, axis] : tried) {
    if (static_cast<int>(starts.size()) >= kTried || share < 0.4) break;
    if (apart(starts, axis)) starts.push_back(axis);
  }
  std::vector<double> score(starts.size());
  parallel_for(starts.size(), num_threads, [&](std::size_t i) {
    score[i] = climb(match, angles, starts[i]);
    if (score[i] >= kPromising) score[i] = worst_share(match, starts[i], angles);
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
    const bool known = std::ranges::any_of(
        group, [&](const Pose& g) { return rotation_angle(g.rotation, pose.rotation) < kSame; });
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

// A turn by a part of the whole.
struct Turn {
  Axis axis;
  int order = 2;  // how many of it make a whole turn
};

// The point that all axes pass by most closely, and that is near `mean` where they leave it open.
Eigen::Vector3d common_point(const std::vector<Turn>& turns, const Eigen::Vector3d& mean) {
  constexpr double kPull = 1e-3;
  Eigen::Matrix3d normal = kPull * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();  // all relative to the mean
  for (const Turn& turn : turns) {
    const Eigen::Vector3d& d = turn.axis.direction;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    normal += across;
    right += across * (turn.axis.point - mean);
  }
  return mean + solve_symmetric(normal, right);
}

// The axis about which turns of several orders follow one another so closely, 24 degrees or less,
// that the surface may well turn by any angle; it does if it nearly passes that test. Noise may
// keep a scanned bowl just below the threshold for some angle and above it for others.
std::optional<Axis> nearly_continuous(const SelfMatch& match, const std::vector<Turn>& turns) {
  constexpr int kMany = 15;
  for (const Turn& one : turns) {
    int together = one.order;
    for (const Turn& other : turns) {
      if (std::abs(one.axis.direction.dot(other.axis.direction)) < std::cos(0.14)) continue;
      together = std::lcm(together, other.order);
    }
    if (together < kMany) continue;
    if (worst_share(match, one.axis, kAnyTurns) >= kNearly) return one.axis;
  }
  return std::nullopt;
}

// A surface that turns about these axes by any angle.
SymmetryGroup continuous_group(const SelfMatch& match, const std::vector<Axis>& axes) {
  SymmetryGroup group;
  for (const Axis& axis : axes) {
    const Eigen::Vector3d along = axis.direction * axis.direction.dot(match.mean() - axis.point);
    group.continuous.push_back({upright(axis.direction), axis.point + along});
  }
  if (axes.size() > 1) return group;
  const ContinuousSymmetry& only = group.continuous.front();
  const Axis across{only.axis.unitOrthogonal(), only.point};
  if (match.exact_share(across, M_PI) >= kSymmetric) {
    group.discrete.push_back(turn_about(across.point, across.direction, M_PI));
  }
  return group;
}

}  // namespace

SymmetryGroup find_symmetries(const PointCloud& surface, double diameter, int num_threads) {
  SymmetryGroup group;
  if (surface.size() < 100) return group;
  const SelfMatch match(surface, static_cast<float>(std::max(0.0015, 0.012 * diameter)));
  const std::vector<Axis> continuous = axes_of(match, kAnyTurns, num_threads);
  if (!continuous.empty()) return continuous_group(match, continuous);
  std::vector<Turn> turns;
  for (int order = 6; order >= 2; --order) {
    for (const Axis& axis : axes_of(match, {kTurn / order}, num_threads)) {
      turns.push_back({axis, order});
    }
  }
  if (const auto axis = nearly_continuous(match, turns)) return continuous_group(match, {*axis});
  const Eigen::Vector3d centre = common_point(turns, match.mean());
  std::vector<Pose> poses;
  for (const Turn& turn : turns) {
    poses.push_back(turn_about(centre, upright(turn.axis.direction), kTurn / turn.order));
  }
  group.discrete = closed(std::move(poses));
  return group;
}

std::string describe(const SymmetryGroup& group) {
  if (group.trivial()) return "none";
  std::string text;
  for (const auto& [a, point] : group.continuous) {
    const Eigen::Vector3d p = 1000 * (point - a * a.dot(point));
    text += cv::format("; any turn about (%.2f, %.2f, %.2f) through (%.1f, %.1f, %.1f) mm", a.x(),
                       a.y(), a.z(), p.x(), p.y(), p.z());
  }
  for (const Pose& pose : group.discrete) {
    const Eigen::Vector3d v = vector_from_rotation(pose.rotation);
    const Eigen::Vector3d a = upright(v.normalized());
    text += cv::format("; %.0f degrees about (%.2f, %.2f, %.2f)", v.norm() * 180 / M_PI, a.x(),
                       a.y(), a.z());
  }
  return text.substr(2);
}

}  // namespace bpa::modeling
