// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The resting positions show different parts of one object. All ways of laying the surface of one
// onto that of the first are tried (registration.hpp); the right one is that which no view
// contradicts: nothing floats in front of what a view measured, nothing is below the table, and
// colours agree.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/modeling/registration.hpp"
#include "core/modeling/trace_occupancy.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa::modeling {
namespace {

constexpr float kCell = 0.003f;  // metres

// The surface that one resting position shows, with colours.
PointCloud surface_of_position(const RestingPosition& position, int num_threads) {
  const OccupancyGrid grid = trace_occupancy(position.views, kCell, num_threads);
  PointCloud surface = surface_of(grid, 0.004f, num_threads).points;
  surface.colors = observe_surface(surface, position.views, num_threads).colors;
  return surface;
}

// The least depth at a pixel and its neighbours: edges are ragged by a pixel.
float nearest_about(const SurfaceMap& map, int x, int y) {
  float nearest = std::numeric_limits<float>::infinity();
  for (int v = std::max(0, y - 1); v <= std::min(map.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(map.width() - 1, x + 1); ++u) {
      const float depth = map.depth[v * map.width() + u];
      if (depth > 0) nearest = std::min(nearest, depth);
    }
  }
  return nearest;
}

// How much a set of views has against points that are said to be on the object's surface, in
// [0, 1]: they float before what was measured, or lie under the table. Colour counts a little.
struct Objection {
  double free_space = 0;  // share of the comparisons
  double color = 0;       // mean difference, as a share of 255
};

Objection objection(const PointCloud& points, const Pose& object_from_points,
                    const std::vector<PosedView>& views) {
  constexpr float kBelowTable = 0.006f, kFree = 0.010f;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 400);
  const std::size_t view_stride = std::max<std::size_t>(1, views.size() / 12);
  double compared = 0, free = 0, colored = 0, color = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector3d p = object_from_points * points.points[i].cast<double>();
    const Eigen::Vector3d n = object_from_points.rotation * points.normals[i].cast<double>();
    // The table hides what is under it from every view.
    if (p.z() < -kBelowTable) {
      compared += 3, free += 3;
      continue;
    }
    for (std::size_t v = 0; v < views.size(); v += view_stride) {
      const PosedView& view = views[v];
      const Eigen::Vector3d q = view.camera_from_object * p;
      if (q.z() < 0.1) continue;
      const Eigen::Vector2d pixel = view.map.camera.project(q);
      const auto x = static_cast<int>(std::lround(pixel.x()));
      const auto y = static_cast<int>(std::lround(pixel.y()));
      if (x < 0 || y < 0 || x >= view.map.width() || y >= view.map.height()) continue;
      const int k = y * view.map.width() + x;
      const float depth = view.map.depth[k];
      if (!(depth > 0)) continue;
      ++compared;
      const float gap = depth - static_cast<float>(q.z());
      free += nearest_about(view.map, x, y) - static_cast<float>(q.z()) >
              std::max(kFree, 5 * depth_noise(depth));
      const bool faces = (view.camera_from_object.rotation * n).dot(q) < -0.5 * q.norm();
      if (!faces || std::abs(gap) > kFree || points.colors.empty() || view.colors.empty()) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        color += std::abs(view.colors[k][c] - points.colors[i][c]) / (3 * 255.0);
      }
      ++colored;
    }
  }
  return {compared > 0 ? free / compared : 1, colored > 0 ? color / colored : 0};
}

struct Choice {
  Pose pose;
  double score = -1e9;
  double overlap = 0, free_space = 1;
};

Choice best_way(const PointCloud& source, const RestingPosition& source_position,
                const PointCloud& target, const RestingPosition& target_position,
                const std::vector<Registration>& ways, int num_threads) {
  // One puts an object down another way to show what it hid before: of a box whose ends look the
  // same, both scans might as well be of the same end.
  constexpr double kSameSideDown = 0.4, kSameUp = 0.9;
  std::vector<Choice> choices(ways.size());
  parallel_for(ways.size(), num_threads, [&](std::size_t i) {
    const Pose& pose = ways[i].target_from_source;
    const Objection there = objection(source, pose, target_position.views);
    const Objection back = objection(target, pose.inverse(), source_position.views);
    const double free = there.free_space + back.free_space;
    const double up = (pose.rotation * Eigen::Vector3d::UnitZ()).z();
    const double score = ways[i].overlap - 6 * free - 4 * (there.color + back.color) -
                         (up > kSameUp ? kSameSideDown : 0);
    choices[i] = {pose, score, ways[i].overlap, free};
  });
  const auto best = std::ranges::max_element(choices, {}, &Choice::score);
  return best == choices.end() ? Choice() : *best;
}

// An object stands on its table in every resting position. What one scan shows of the face that the
// object stands on in the other one must lie on that one's table: of a can upside down, nothing
// else says how far it is from one end to the other, since its side slides along itself.
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
  std::ranges::nth_element(heights, heights.begin() + heights.size() / 10);
  const double height = heights[heights.size() / 10];
  const std::size_t face =
      std::ranges::count_if(heights, [&](double h) { return std::abs(h - height) < kThickness; });
  if (face < fewest || std::abs(height) > kHighest) return std::nullopt;
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
  constexpr float kFacesAlike = 0.7f;  // cosine between normals
  ShiftSums sums;
  const FastPose fast = to_fast(pose);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f p = fast * source.points[i];
    const Eigen::Vector3f n = fast.rotation * source.normals[i];
    float best = kReach * kReach;
    int found = -1;
    near.for_each_neighbor(p, [&](int j, float squared) {
      if (n.dot(target.normals[j]) < kFacesAlike || squared > best) return;
      best = squared;
      found = j;
    });
    if (found < 0) continue;
    const double off = target.normals[found].dot(target.points[found] - p);
    sums.add(target.normals[found].cast<double>(), off, 1);
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
    const Eigen::Vector3d shift = solve_symmetric(sums.hessian, sums.gradient);
    pose.translation += shift;
    if (shift.norm() < 1e-5) break;
  }
  return pose;
}

std::vector<std::string> merge_resting_positions(std::vector<RestingPosition>& positions,
                                                 const ScanOptions& options) {
  constexpr double kLeastOverlap = 0.35, kMostFree = 0.12;
  std::vector<std::string> problems;
  if (positions.size() < 2) return problems;
  std::vector<PointCloud> surfaces;
  for (const RestingPosition& p : positions) {
    surfaces.push_back(surface_of_position(p, options.num_threads));
  }
  const RegistrationOptions registration{
      .kept = 160,  // a can has dozens of ways to stand, and as many upside down
      .seed = options.seed,
      .num_threads = options.num_threads};
  for (std::size_t k = 1; k < positions.size(); ++k) {
    const std::vector<Registration> ways =
        register_surfaces(surfaces[k], surfaces[0], registration);
    const Choice best =
        best_way(surfaces[k], positions[k], surfaces[0], positions[0], ways, options.num_threads);
    if (best.overlap < kLeastOverlap || best.free_space > kMostFree) {
      problems.push_back(concat("resting position ", k + 1,
                                " could not be laid onto the first one and was left out"));
      positions[k].views.clear();
      continue;
    }
    const Pose source_from_target = settle_on_tables(surfaces[k], surfaces[0], best.pose).inverse();
    for (PosedView& view : positions[k].views) {
      view.camera_from_object = view.camera_from_object * source_from_target;
    }
  }
  return problems;
}

Result<AlignedScan> align_scan(std::vector<std::vector<ScanView>> positions,
                               const ScanOptions& options) {
  AlignedScan out;
  std::vector<RestingPosition> aligned;
  Status last(StatusCode::not_found, "the scan has no views");
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const std::size_t count = positions[k].size();
    Result<RestingPosition> position = align_resting_position(std::move(positions[k]), options);
    const std::string name = "resting position " + std::to_string(k + 1);
    if (!position.ok()) {
      last = position.status();
      out.warnings.push_back(name + " was left out: " + last.message);
      continue;
    }
    if (position->missed > 0) {
      out.warnings.push_back(
          concat(position->missed, " of ", count, " views of ", name, " do not show the object"));
    }
    aligned.push_back(std::move(*position));
  }
  if (aligned.empty()) return last;
  double evidence = 0;
  for (const RestingPosition& position : aligned) evidence += position.sense_evidence;
  const int sense = evidence >= 0 ? 1 : -1;
  for (RestingPosition& position : aligned) {
    if (position.step_deg * sense < 0) find_axis(position, sense, options);
  }
  std::ranges::move(merge_resting_positions(aligned, options), std::back_inserter(out.warnings));
  for (RestingPosition& position : aligned) {
    std::ranges::move(position.views, std::back_inserter(out.views));
    position.views.clear();
    out.positions.push_back(std::move(position));
  }
  return out;
}

}  // namespace bpa::modeling
