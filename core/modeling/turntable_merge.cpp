// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The resting positions show different parts of one object. All ways of laying the surface of one
// onto that of the first are tried (registration.hpp); the right one is that which no view
// contradicts: nothing floats in front of what a view measured, nothing is below the table, and
// colours agree.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/modeling/registration.hpp"
#include "core/modeling/trace_occupancy.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa {
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
      const float depth = map.depth[static_cast<std::size_t>(v * map.width() + u)];
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
    if (p.z() < -static_cast<double>(kBelowTable)) {
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
      const auto k = static_cast<std::size_t>(y * view.map.width() + x);
      const float depth = view.map.depth[k];
      if (!(depth > 0)) continue;
      ++compared;
      const float gap = depth - static_cast<float>(q.z());
      free += nearest_about(view.map, x, y) - static_cast<float>(q.z()) >
              std::max(kFree, 5 * depth_noise(depth));
      const bool faces = (view.camera_from_object.rotation * n).dot(q) < -0.5 * q.norm();
      if (!faces || std::abs(gap) > kFree || points.colors.empty() || view.colors.empty()) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        color += std::abs(static_cast<double>(view.colors[k][c]) - points.colors[i][c]) / (3 * 255);
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
  parallel_for(static_cast<int>(ways.size()), num_threads, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    const Pose& pose = ways[i].target_from_source;
    const Objection there = objection(source, pose, target_position.views);
    const Objection back = objection(target, pose.inverse(), source_position.views);
    const double free = there.free_space + back.free_space;
    const double up = (pose.rotation * Eigen::Vector3d::UnitZ()).z();
    const double score = ways[i].overlap - 6 * free - 4 * (there.color + back.color) -
                         (up > kSameUp ? kSameSideDown : 0);
    choices[i] = {pose, score, ways[i].overlap, free};
  });
  Choice best;
  for (const Choice& c : choices) {
    if (c.score > best.score) best = c;
  }
  return best;
}

}  // namespace

std::vector<std::string> merge_resting_positions(std::vector<RestingPosition>& positions,
                                                 const ScanOptions& options) {
  constexpr double kLeastOverlap = 0.35, kMostFree = 0.12;
  std::vector<std::string> problems;
  if (positions.size() < 2) return problems;
  std::vector<PointCloud> surfaces;
  for (const RestingPosition& p : positions) {
    surfaces.push_back(surface_of_position(p, options.num_threads));
  }
  RegistrationOptions registration;
  registration.kept = 160;  // a can has dozens of ways to stand, and as many upside down
  registration.seed = options.seed;
  registration.num_threads = options.num_threads;
  for (std::size_t k = 1; k < positions.size(); ++k) {
    const std::vector<Registration> ways =
        register_surfaces(surfaces[k], surfaces[0], registration);
    const Choice best =
        best_way(surfaces[k], positions[k], surfaces[0], positions[0], ways, options.num_threads);
    if (best.overlap < kLeastOverlap || best.free_space > kMostFree) {
      problems.push_back("resting position " + std::to_string(k + 1) +
                         " could not be laid onto the first one and was left out");
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
      out.warnings.push_back(std::to_string(position->missed) + " of " + std::to_string(count) +
                             " views of " + name + " do not show the object");
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
  for (std::string& problem : merge_resting_positions(aligned, options)) {
    out.warnings.push_back(std::move(problem));
  }
  for (RestingPosition& position : aligned) {
    for (PosedView& view : position.views) out.views.push_back(std::move(view));
    position.views.clear();
    out.positions.push_back(std::move(position));
  }
  return out;
}

}  // namespace bpa
