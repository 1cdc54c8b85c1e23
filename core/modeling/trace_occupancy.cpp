// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/trace_occupancy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/model/view_sphere.hpp"

namespace bpa::modeling {
namespace {

constexpr float kMinCosine = 0.2f;  // of views that count

FastPose object_from_camera(const PosedView& view) {
  return to_fast(view.camera_from_object.inverse());
}

// Calls visit(point, normal, weight), object frame, for the object's pixels that are seen well.
void for_each_measurement(const std::vector<PosedView>& views, const auto& visit) {
  for (const PosedView& view : views) {
    const FastPose pose = object_from_camera(view);
    for (std::size_t i = 0; i < view.map.size(); ++i) {
      if (!view.object[i] || !(view.map.depth[i] > 0)) continue;
      const Eigen::Vector3f& normal = view.map.normals[i];
      const float cosine = -normal.dot(view.map.points[i].normalized());
      if (!(cosine > kMinCosine)) continue;
      visit(pose * view.map.points[i], Eigen::Vector3f(pose.rotation * normal), cosine * cosine);
    }
  }
}

// Grid cells by number, and which of them are held.
struct Lookup {
  const OccupancyGrid& grid;
  std::vector<std::int32_t> slot;  // -1 where no ray ends

  std::int64_t number(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f scaled = (p - grid.low) / grid.cell;
    if (!(scaled.minCoeff() >= 0)) return -1;
    const Eigen::Vector3i c = scaled.cast<int>();
    if ((c.array() >= grid.size.array()).any()) return -1;
    return (static_cast<std::int64_t>(c.z()) * grid.size.y() + c.y()) * grid.size.x() + c.x();
  }
  Eigen::Vector3i place(std::int64_t n) const {
    const std::int64_t row = n / grid.size.x();
    return {static_cast<int>(n % grid.size.x()), static_cast<int>(row % grid.size.y()),
            static_cast<int>(row / grid.size.y())};
  }
};

// Sums over the rays that end in a cell.
struct CellSums {
  Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();  // of the normals
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();     // tells the buckets apart
  std::array<Eigen::Vector3f, 2> position{Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  std::array<Eigen::Vector3f, 2> normal{Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  std::array<float, 2> weight{0, 0}, squared_angles{0, 0};
  std::array<int, 2> rays{0, 0};
};

// The cells where rays end, with the means of their buckets.
std::vector<CellSums> sum_endings(const std::vector<PosedView>& views, Lookup& lookup,
                                  OccupancyGrid& grid) {
  std::vector<CellSums> sums;
  for_each_measurement(views, [&](const auto& p, const auto& n, float) {
    const std::int64_t number = lookup.number(p);
    if (number < 0) return;
    std::int32_t& slot = lookup.slot[number];
    if (slot < 0) {
      slot = static_cast<std::int32_t>(sums.size());
      sums.emplace_back();
      grid.cells.push_back({lookup.place(number), {}});
    }
    sums[slot].scatter += n * n.transpose();
  });
  // Calls visit(sums, bucket, point, normal, weight).
  const auto for_each = [&](const auto& visit) {
    for_each_measurement(views, [&](const auto& p, const auto& n, float w) {
      const std::int64_t number = lookup.number(p);
      if (number < 0) return;
      CellSums& s = sums[lookup.slot[number]];
      visit(s, n.dot(s.axis) >= 0 ? 0 : 1, p, n, w);
    });
  };
  for (CellSums& s : sums) {
    s.axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(s.scatter).eigenvectors().col(2);
  }
  for_each([](CellSums& s, int b, const auto& p, const auto& n, float w) {
    s.position[b] += w * p;
    s.normal[b] += w * n;
    s.weight[b] += w;
    ++s.rays[b];
  });
  for (CellSums& s : sums) {
    for (Eigen::Vector3f& normal : s.normal) normal.normalize();
  }
  for_each([](CellSums& s, int b, const auto&, const auto& n, float) {
    const float angle = std::acos(std::clamp(n.dot(s.normal[b]), -1.0f, 1.0f));
    s.squared_angles[b] += angle * angle;
  });
  return sums;
}

// Calls visit(cell number) for every cell of the grid on the way from `from` to `from` + `length` *
// `direction` (Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987).
void march(const OccupancyGrid& grid, const Eigen::Vector3f& from, const Eigen::Vector3f& direction,
           float length, const auto& visit) {
  const Eigen::Vector3f high = grid.low + grid.cell * grid.size.cast<float>();
  float t = 0, end = length;
  for (int a = 0; a < 3; ++a) {
    if (std::abs(direction[a]) < 1e-9f) {
      if (from[a] < grid.low[a] || from[a] >= high[a]) return;
      continue;
    }
    const auto [enter, leave] =
        std::minmax({(grid.low[a] - from[a]) / direction[a], (high[a] - from[a]) / direction[a]});
    t = std::max(t, enter);
    end = std::min(end, leave);
  }
  if (t >= end) return;
  const Eigen::Vector3f start = (from + t * direction - grid.low) / grid.cell;
  Eigen::Vector3i c, step;
  Eigen::Vector3f next, delta;
  for (int a = 0; a < 3; ++a) {
    c[a] = std::clamp(static_cast<int>(std::floor(start[a])), 0, grid.size[a] - 1);
    step[a] = direction[a] > 0 ? 1 : -1;
    const bool moves = std::abs(direction[a]) >= 1e-9f;
    const float border = grid.low[a] + grid.cell * (c[a] + (step[a] > 0 ? 1 : 0));
    next[a] = moves ? (border - from[a]) / direction[a] : std::numeric_limits<float>::infinity();
    delta[a] = moves ? grid.cell / std::abs(direction[a]) : next[a];
  }
  while (true) {
    visit((static_cast<std::int64_t>(c.z()) * grid.size.y() + c.y()) * grid.size.x() + c.x());
    int a = next.x() < next.y() ? 0 : 1;
    if (next.z() < next[a]) a = 2;
    if (next[a] >= end) return;
    c[a] += step[a];
    if (c[a] < 0 || c[a] >= grid.size[a]) return;
    next[a] += delta[a];
  }
}

// Counts, for both buckets of every cell, the rays of one view that pass through.
void count_passing(const PosedView& view, const Lookup& lookup, const std::vector<CellSums>& sums,
                   std::vector<std::int32_t>& passing) {
  const FastPose pose = object_from_camera(view);
  const SurfaceMap& map = view.map;
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      const int i = v * map.width() + u;
      if (!(map.depth[i] > 0)) continue;
      const Eigen::Vector3f ray = map.camera.unproject(u, v, 1).cast<float>();
      const Eigen::Vector3f direction = pose.rotation * ray;
      const float cosine = std::max(0.2f, -map.normals[i].dot(ray) / ray.norm());
      const float margin =
          std::max(3 * depth_noise(map.depth[i]), 1.8f * lookup.grid.cell) / std::sqrt(cosine);
      march(lookup.grid, pose.translation, direction, map.depth[i] - margin,
            [&](std::int64_t number) {
              const std::int32_t s = lookup.slot[number];
              if (s < 0) return;
              for (std::size_t b = 0; b < 2; ++b) {
                if (sums[s].rays[b] == 0) continue;
                if (sums[s].normal[b].dot(direction) < -kMinCosine * direction.norm()) {
                  ++passing[2 * s + b];
                }
              }
            });
    }
  }
}

// Draws points along their normals to the sheet that they and their neighbours scatter about.
void draw_together(PointCloud& cloud, const std::vector<float>& weight, float radius,
                   int num_threads) {
  constexpr float kSameSheet = 0.8f;  // cosine between normals
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const NeighborGrid neighbors(cloud.points, radius);
    std::vector<Eigen::Vector3f> moved = cloud.points;
    parallel_for(cloud.size(), num_threads, [&](std::size_t i) {
      const Eigen::Vector3f& n = cloud.normals[i];
      float sum = 0, total = 0;
      neighbors.for_each_neighbor(cloud.points[i], [&](int j, float squared) {
        const float cosine = n.dot(cloud.normals[j]);
        if (cosine < kSameSheet) return;
        const float near = 1 - squared / (radius * radius);
        const float w = weight[j] * near * near;
        sum += w * n.dot(cloud.points[j] - cloud.points[i]);
        total += w;
      });
      if (total > 0) moved[i] += sum / total * n;
    });
    cloud.points = std::move(moved);
  }
}

// The points that some view angle sees; the others are inside.
PointCloud seen_from_outside(const PointCloud& cloud, float spacing, int num_threads) {
  std::vector<std::uint8_t> outside(cloud.size(), 0);
  for (const ModelView& view : render_views(cloud, spacing, num_threads)) {
    for (const std::uint32_t i : view.visible) outside[i] = 1;
  }
  return select(cloud, [&outside](int i) { return outside[i] != 0; });
}

}  // namespace

OccupancyGrid trace_occupancy(const std::vector<PosedView>& views, float cell, int num_threads) {
  constexpr double kMaxCells = 3e7;
  OccupancyGrid grid;
  Eigen::AlignedBox3f box;
  for_each_measurement(views, [&](const auto& p, const auto&, float) { box.extend(p); });
  grid.cell = cell;
  if (box.isEmpty()) return grid;
  for (;; grid.cell *= 1.2f) {
    grid.low = box.min().array() - grid.cell;
    grid.size = (box.sizes() / grid.cell).array().floor().cast<int>() + 3;
    if (grid.size.cast<double>().prod() <= kMaxCells) break;
  }
  Lookup lookup{grid, std::vector<std::int32_t>(grid.size.prod(), -1)};
  const std::vector<CellSums> sums = sum_endings(views, lookup, grid);
  std::vector<std::int32_t> passing(2 * sums.size(), 0);
  std::mutex mutex;  // counts are added up; the order does not matter
  parallel_for(views.size(), num_threads, [&](std::size_t k) {
    std::vector<std::int32_t> own(passing.size(), 0);
    count_passing(views[k], lookup, sums, own);
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < own.size(); ++i) passing[i] += own[i];
  });
  for (std::size_t s = 0; s < sums.size(); ++s) {
    for (std::size_t b = 0; b < 2; ++b) {
      const int rays = sums[s].rays[b];
      if (rays == 0) continue;
      const float count = rays;
      grid.cells[s].buckets[b] = {count / (count + passing[2 * s + b]), rays,
                                  sums[s].position[b] / sums[s].weight[b], sums[s].normal[b],
                                  sums[s].squared_angles[b] / count};
    }
  }
  return grid;
}

GridSurface surface_of(const OccupancyGrid& grid, float spacing, int num_threads) {
  PointCloud cloud;  // of the occupied buckets
  std::vector<float> rays, normal_variance;
  for (const OccupancyCell& cell : grid.cells) {
    for (const ViewBucket& bucket : cell.buckets) {
      if (!occupied(bucket)) continue;
      cloud.points.push_back(bucket.position);
      cloud.normals.push_back(bucket.normal);
      normal_variance.push_back(bucket.normal_variance);
      rays.push_back(bucket.rays);
    }
  }
  GridSurface out;
  if (cloud.empty()) return out;
  draw_together(cloud, rays, std::max(0.006f, 2.2f * grid.cell), num_threads);
  out.points = downsample(seen_from_outside(cloud, std::max(0.003f, 1.2f * grid.cell), num_threads),
                          spacing);
  // About the normal of a point: the mean of those it was made of, about theirs, and what lies
  // between the two.
  const NeighborGrid neighbors(cloud.points, spacing);
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    float sum = 0, total = 0;
    neighbors.for_each_neighbor(out.points.points[i], [&](int j, float) {
      const float cosine = cloud.normals[j].dot(out.points.normals[i]);
      if (cosine < 0.5f) return;
      const float bias = std::acos(std::min(1.0f, cosine));
      sum += rays[j] * (normal_variance[j] + bias * bias);
      total += rays[j];
    });
    out.normal_variance.push_back(total > 0 ? sum / total : 0);
  }
  return out;
}

}  // namespace bpa::modeling
