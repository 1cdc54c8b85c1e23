// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The centre of rotation. Turned back about the right place, all scans of a resting position fall
// onto each other: the cost of a place is the mean squared distance of each scan's points to every
// other scan (paper section III). It is tried all over the table, then refined by Gauss-Newton with
// distances to tangent planes; then also the step of the table (within a few per cent) and the tilt
// of its axis (within a fraction of a degree) follow from the scans.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa::modeling {
namespace {

constexpr double kDegree = M_PI / 180;

// The object's points of one view, on the table: z is the height.
struct Scan {
  int step = 0;
  PointCloud cloud;
};

// Where the axis is and how far the table turns with each step.
struct Turn {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double step = 0;    // radians, signed
  double tilt_x = 0;  // of the axis, radians
  double tilt_y = 0;

  Eigen::Vector3d axis() const { return Eigen::Vector3d(tilt_x, tilt_y, 1).normalized(); }
  // Turns a view's points back to where they were in the first view.
  Pose first_from_view(int k) const {
    const Eigen::Quaterniond back(Eigen::AngleAxisd(-step * k, axis()));
    const Eigen::Vector3d c(centre.x(), centre.y(), 0);
    return {back, c - back * c};
  }
};

using Parameters = Eigen::Matrix<double, 5, 1>;  // centre, log of the step's size, tilt

Turn moved(const Turn& turn, const Parameters& p) {
  Turn out = turn;
  out.centre += p.head<2>();
  out.step *= std::exp(p[2]);
  out.tilt_x += p[3];
  out.tilt_y += p[4];
  return out;
}

Pose camera_from_table(const Plane& plane) {
  const Eigen::Vector3d z = plane.normal.cast<double>().normalized();
  const Eigen::Vector3d x = z.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  return Pose::from_matrix(axes, plane.offset * z);
}

// At most `count` points of each scan, evenly taken.
std::vector<Scan> thinned(const std::vector<Scan>& scans, std::size_t count, std::size_t stride) {
  std::vector<Scan> out;
  for (std::size_t s = 0; s < scans.size(); s += stride) {
    const std::size_t n = scans[s].cloud.size(), kept = std::min(count, n);
    std::vector<int> chosen(kept);
    for (std::size_t i = 0; i < kept; ++i) chosen[i] = i * n / kept;
    out.push_back({scans[s].step, select(scans[s].cloud, chosen)});
  }
  return out;
}

// All scans turned back, in one list.
struct Merged {
  std::vector<Eigen::Vector3f> points, normals;
  std::vector<std::uint16_t> scan;

  Merged(const std::vector<Scan>& scans, const Turn& turn) {
    std::uint16_t number = 0;
    for (const auto& [step, cloud] : scans) {
      const FastPose pose = to_fast(turn.first_from_view(step));
      for (const Eigen::Vector3f& p : cloud.points) points.push_back(pose * p);
      for (const Eigen::Vector3f& n : cloud.normals) normals.emplace_back(pose.rotation * n);
      scan.insert(scan.end(), cloud.size(), number++);
    }
  }
};

// For one point, the nearest point of every other scan within the grid's radius.
struct Nearest {
  std::vector<float> squared;
  std::vector<int> index;

  explicit Nearest(std::size_t scans) : squared(scans), index(scans) {}

  void search(const Merged& all, const NeighborGrid& grid, std::size_t i, float radius) {
    std::fill(squared.begin(), squared.end(), radius * radius);
    std::fill(index.begin(), index.end(), -1);
    grid.for_each_neighbor(all.points[i], [&](int k, float d) {
      const std::uint16_t s = all.scan[k];
      if (s == all.scan[i] || d >= squared[s] || all.normals[i].dot(all.normals[k]) < 0.5f) return;
      squared[s] = d;
      index[s] = k;
    });
  }
};

double cost_of(const std::vector<Scan>& scans, const Turn& turn, float radius) {
  const Merged all(scans, turn);
  const NeighborGrid grid(all.points, radius);
  Nearest nearest(scans.size());
  double sum = 0;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    nearest.search(all, grid, i, radius);
    for (const float d : nearest.squared) sum += d;
  }
  return sum / (static_cast<double>(all.points.size()) * scans.size());
}

struct Trial {
  Turn turn;
  double cost = 0;
};

// Centres that are tried: a square lattice, metres.
struct Lattice {
  Eigen::Vector2d middle;
  double reach, spacing;
};

// The best of a lattice of centres.
Trial search(const std::vector<Scan>& scans, double step, const Lattice& lattice, float radius,
             int num_threads) {
  std::vector<Trial> trials;
  const int n = static_cast<int>(std::ceil(lattice.reach / lattice.spacing));
  for (int y = -n; y <= n; ++y) {
    for (int x = -n; x <= n; ++x) {
      trials.push_back({{lattice.middle + lattice.spacing * Eigen::Vector2d(x, y), step}});
    }
  }
  parallel_for(trials.size(), num_threads,
               [&](std::size_t k) { trials[k].cost = cost_of(scans, trials[k].turn, radius); });
  return *std::ranges::min_element(trials, {}, &Trial::cost);
}

// How the pose of each view changes with each parameter: p -> rotation * p + translation.
struct Slope {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

std::vector<std::array<Slope, 5>> slopes_of(const std::vector<Scan>& scans, const Turn& turn) {
  constexpr double kStep = 1e-6;
  std::vector<std::array<Slope, 5>> slopes(scans.size());
  for (std::size_t s = 0; s < scans.size(); ++s) {
    for (int k = 0; k < 5; ++k) {
      const Pose a = moved(turn, kStep * Parameters::Unit(k)).first_from_view(scans[s].step);
      const Pose b = moved(turn, -kStep * Parameters::Unit(k)).first_from_view(scans[s].step);
      slopes[s][k] = {(a.matrix() - b.matrix()) / (2 * kStep),
                      (a.translation - b.translation) / (2 * kStep)};
    }
  }
  return slopes;
}

// The normal equations of a Gauss-Newton step.
struct StepEquations {
  Eigen::Matrix<double, 5, 5> hessian = Eigen::Matrix<double, 5, 5>::Zero();
  Parameters gradient = Parameters::Zero();
  double pairs = 0;
};

// Of the distances of each point to the tangent planes of the nearest points in the other scans.
StepEquations pair_equations(const std::vector<Scan>& scans, float radius, const Turn& turn) {
  constexpr double kHuber = 0.002;  // metres
  const Merged all(scans, turn);
  const NeighborGrid grid(all.points, radius);
  const auto slopes = slopes_of(scans, turn);
  std::vector<Eigen::Vector3f> measured;  // as all.points, before turning
  for (const auto& [step, cloud] : scans) {
    measured.insert(measured.end(), cloud.points.begin(), cloud.points.end());
  }
  const auto slope_at = [&](std::size_t i, int k) -> Eigen::Vector3d {
    const Slope& s = slopes[all.scan[i]][k];
    return s.rotation * measured[i].cast<double>() + s.translation;
  };
  StepEquations out;
  Nearest nearest(scans.size());
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    nearest.search(all, grid, i, radius);
    for (const int j : nearest.index) {
      if (j < 0) continue;
      const Eigen::Vector3d n = all.normals[j].cast<double>();
      const double r = n.dot((all.points[i] - all.points[j]).cast<double>());
      const double weight = std::abs(r) < kHuber ? 1 : kHuber / std::abs(r);
      Parameters slope;
      for (int k = 0; k < 5; ++k) slope[k] = n.dot(slope_at(i, k) - slope_at(j, k));
      out.hessian += weight * slope * slope.transpose();
      out.gradient += weight * r * slope;
      ++out.pairs;
    }
  }
  return out;
}

// One Gauss-Newton step of all parameters; returns its length in metres of centre.
double refine(const std::vector<Scan>& scans, float radius, const Turn& start, bool step_known,
              Turn& turn) {
  constexpr double kLeastPairs = 50;
  constexpr double kSigma = 0.002;  // of a distance, metres
  // Neighbouring pixels share their errors: a pair of scans is worth some 30 independent pairs.
  constexpr double kIndependent = 30;
  // What is known beforehand: the step within 3 %, the axis within 0.15 degrees of the normal.
  constexpr double kStepSigma = 0.03, kTiltSigma = 0.15 * kDegree;
  auto [hessian, gradient, pairs] = pair_equations(scans, radius, turn);
  if (pairs < kLeastPairs) return 0;
  const double worth = kIndependent * (scans.size() * scans.size()) / pairs / (kSigma * kSigma);
  hessian *= worth;
  gradient *= worth;
  const double step_prior = step_known ? 1e12 : 1 / (kStepSigma * kStepSigma);
  const double tilt_prior = 1 / std::pow(kTiltSigma, 2);
  hessian(2, 2) += step_prior;
  gradient[2] += step_prior * std::log(turn.step / start.step);
  hessian(3, 3) += tilt_prior, hessian(4, 4) += tilt_prior;
  gradient[3] += tilt_prior * turn.tilt_x, gradient[4] += tilt_prior * turn.tilt_y;
  hessian.diagonal().head<2>().array() += 1;  // an object right on its axis says nothing
  const Parameters step = -solve_symmetric(hessian, gradient);
  turn = moved(turn, step);
  return step.head<2>().norm();
}

// Either way round: the best turn and what it costs.
std::array<Trial, 2> find_turns(const std::vector<Scan>& scans, const ScanOptions& options) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  float reach = 0;
  for (const auto& [step, cloud] : scans) {
    Eigen::Vector2f mean = Eigen::Vector2f::Zero();
    for (const Eigen::Vector3f& p : cloud.points) mean += p.head<2>();
    mean /= cloud.size();
    for (const Eigen::Vector3f& p : cloud.points) {
      reach = std::max(reach, (p.head<2>() - mean).norm());
    }
    middle += mean.cast<double>() / scans.size();
  }
  // The side that is seen is nearer to the camera than the middle; the object is off the centre.
  const double window = 0.06 + 0.5 * reach;
  const std::size_t stride = std::max<std::size_t>(1, scans.size() / 12);
  const std::vector<Scan> few = thinned(scans, 70, stride), more = thinned(scans, 150, stride);
  std::array<Trial, 2> best;
  for (std::size_t k = 0; k < 2; ++k) {
    const double step = (k == 0 ? 1 : -1) * options.step_deg * kDegree;
    best[k] = search(few, step, {middle, window, 0.012}, 0.03f, options.num_threads);
    best[k] = search(more, step, {best[k].turn.centre, 0.010, 0.004}, 0.015f, options.num_threads);
  }
  return best;
}

Turn refined(const std::vector<Scan>& scans, const Turn& start, bool step_known) {
  constexpr double kMostWrong = 0.08;
  Turn turn = start;
  const std::vector<Scan> many = thinned(scans, 250, 1);
  for (const float radius : {0.015f, 0.010f, 0.007f, 0.006f}) {
    for (int round = 0; round < 6; ++round) {
      if (refine(many, radius, start, step_known, turn) < 1e-5) break;
    }
  }
  // The scans of an object that looks alike from all sides say nothing about the step.
  const bool lost = std::abs(std::log(turn.step / start.step)) > kMostWrong;
  return lost && !step_known ? refined(scans, start, true) : turn;
}

// Whether a pixel shows the object, and not at too flat an angle.
bool well_seen(const PosedView& view, std::size_t i) {
  return view.object[i] && view.map.normals[i].squaredNorm() > 0.5f &&
         view.map.normals[i].dot(view.map.points[i].normalized()) <= -0.25f;
}

// What the views show of the object, on the table.
std::vector<Scan> scans_of(const std::vector<PosedView>& views, const std::vector<int>& steps,
                           const Pose& table_from_camera) {
  const FastPose pose = to_fast(table_from_camera);
  std::vector<Scan> scans;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const SurfaceMap& map = views[v].map;
    PointCloud& cloud = scans.emplace_back(Scan{steps[v], {}}).cloud;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (!well_seen(views[v], i)) continue;
      cloud.points.push_back(pose * map.points[i]);
      cloud.normals.emplace_back(pose.rotation * map.normals[i]);
    }
  }
  return scans;
}

}  // namespace

void find_axis(RestingPosition& position, int sense, const ScanOptions& options) {
  const Pose camera_from = camera_from_table(position.plane);
  const std::vector<Scan> scans = scans_of(position.views, position.steps, camera_from.inverse());
  const std::array<Trial, 2> trials = find_turns(scans, options);
  position.sense_evidence = trials[1].cost - trials[0].cost;
  if (sense == 0) sense = position.sense_evidence >= 0 ? 1 : -1;
  const Turn turn = refined(scans, trials[sense > 0 ? 0 : 1].turn, false);
  position.centre = camera_from * Eigen::Vector3d(turn.centre.x(), turn.centre.y(), 0);
  position.axis = camera_from.rotation * turn.axis();
  position.step_deg = turn.step / kDegree;
  const Pose first_from_object{Eigen::Quaterniond::Identity(),
                               {turn.centre.x(), turn.centre.y(), 0}};
  for (std::size_t v = 0; v < position.views.size(); ++v) {
    const Pose view_from_first = turn.first_from_view(position.steps[v]).inverse();
    position.views[v].camera_from_object = camera_from * view_from_first * first_from_object;
  }
}

Result<RestingPosition> align_resting_position(std::vector<ScanView> views,
                                               const ScanOptions& options) {
  constexpr std::size_t kLeastPixels = 60, kLeastViews = 3;
  if (views.empty()) return not_found("there are no views");
  RestingPosition out;
  const Result<Plane> plane = segment_object(views, options);
  if (!plane.ok()) return plane.status();
  out.plane = *plane;
  for (ScanView& scan : views) {
    const PosedView& view = scan.view;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < view.map.size(); ++i) pixels += well_seen(view, i);
    if (pixels < kLeastPixels) continue;
    out.views.push_back(std::move(scan.view));
    out.steps.push_back(scan.step);
  }
  out.missed = static_cast<int>(views.size() - out.views.size());
  if (out.views.size() < kLeastViews) {
    return not_found("the object is seen in ", out.views.size(), " of ", views.size(),
                     " views; it must be seen in at least 3");
  }
  find_axis(out, 0, options);
  return out;
}

}  // namespace bpa::modeling
