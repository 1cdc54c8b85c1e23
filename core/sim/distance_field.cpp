// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/distance_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace bpa::sim {
namespace {

// The distance from a rounded corner at the origin whose faces are the coordinate planes.
template <class Vector>
double corner_distance(const Vector& point, double rounding) {
  const Vector q = point.array() + rounding;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

// Dual marching cubes. A cube's corner is three bits (x, y, z). Its edge along axis a, at offsets u
// and v along the next two axes, has number 4 a + u + 2 v.

using Index = std::array<int, 3>;
using EdgeVertices = std::array<int, 12>;

int next(int axis, int by) { return (axis + by) % 3; }

struct Grid {
  Eigen::Vector3d low;
  double cell = 0;
  Index size{};  // samples
  std::vector<double> values;

  int at(const Index& i) const { return (i[2] * size[1] + i[1]) * size[0] + i[0]; }
  Eigen::Vector3d point(const Index& i) const {
    return low + cell * Eigen::Vector3d(i[0], i[1], i[2]);
  }
  bool inside(const Index& i) const { return values[at(i)] < 0; }
  // Of all samples but the last `trim` along each axis.
  template <class Visit>
  void for_each(int trim, const Visit& visit) const {
    for (int z = 0; z < size[2] - trim; ++z) {
      for (int y = 0; y < size[1] - trim; ++y) {
        for (int x = 0; x < size[0] - trim; ++x) visit(Index{x, y, z});
      }
    }
  }
};

Grid sample(const DistanceField& field, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
            double cell) {
  Grid grid{low, cell, {}, {}};
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<int>(std::ceil((high[a] - low[a]) / cell)) + 1;
  }
  grid.for_each(0, [&](const Index& i) { grid.values.push_back(field(grid.point(i))); });
  return grid;
}

// The two samples that an edge of a cube joins.
std::pair<Index, Index> cube_edge(const Index& cell, int edge) {
  const int axis = edge / 4;
  Index from = cell;
  from[next(axis, 1)] += edge & 1;
  from[next(axis, 2)] += (edge >> 1) & 1;
  Index to = from;
  ++to[axis];
  return {from, to};
}

// Groups the crossed edges of a cube into the loops that the surface makes on its faces. Where a
// face is crossed four times, each inside corner is cut off by itself, in both cubes alike.
EdgeVertices loops_of(const Grid& grid, const Index& cell) {
  EdgeVertices group;
  std::iota(group.begin(), group.end(), 0);
  const auto join = [&group](int a, int b) {
    const int from = group[a], to = group[b];
    for (int& g : group) g = g == from ? to : g;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = next(axis, 1), v = next(axis, 2);
    for (int side = 0; side < 2; ++side) {
      // Corners (0,0), (1,0), (1,1), (0,1) in (u, v); edge m joins corners m and m + 1.
      std::array<bool, 4> inside{};
      for (int m = 0; m < 4; ++m) {
        Index corner = cell;
        corner[axis] += side;
        corner[u] += m == 1 || m == 2;
        corner[v] += m >= 2;
        inside[m] = grid.inside(corner);
      }
      // Along u at v = 0 or 1: offsets (v, axis). Along v at u = 1 or 0: offsets (axis, u).
      const std::array<int, 4> edges{4 * u + 0 + 2 * side, 4 * v + side + 2 * 1,
                                     4 * u + 1 + 2 * side, 4 * v + side + 0};
      std::vector<int> crossed;
      for (int m = 0; m < 4; ++m) {
        if (inside[m] != inside[(m + 1) % 4]) crossed.push_back(edges[m]);
      }
      if (crossed.size() == 2) join(crossed[0], crossed[1]);
      if (crossed.size() == 4) {
        for (int m = 0; m < 4; ++m) {
          if (inside[m]) join(edges[(m + 3) % 4], edges[m]);
        }
      }
    }
  }
  return group;
}

Eigen::Vector3d gradient(const DistanceField& field, const Eigen::Vector3d& p, double step) {
  Eigen::Vector3d g;
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(a);
    g[a] = (field(p + offset) - field(p - offset)) / (2 * step);
  }
  return g;
}

Eigen::Vector3d moved_to_surface(const DistanceField& field, Eigen::Vector3d p, double cell) {
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Eigen::Vector3d g = gradient(field, p, 1e-3 * cell);
    Eigen::Vector3d step = -field(p) / std::max(g.squaredNorm(), 0.1) * g;
    if (step.norm() > 0.3 * cell) step *= 0.3 * cell / step.norm();
    p += step;
  }
  return p;
}

// One vertex for each loop of a cube; returns which vertex each crossed edge belongs to.
EdgeVertices add_vertices(const Grid& grid, const Index& cell, const DistanceField& field,
                          TriangleMesh& mesh) {
  const EdgeVertices group = loops_of(grid, cell);
  std::array<Eigen::Vector3d, 12> sums;
  std::array<int, 12> counts{};
  sums.fill(Eigen::Vector3d::Zero());
  std::array<bool, 12> crossed{};
  for (int e = 0; e < 12; ++e) {
    const auto [from, to] = cube_edge(cell, e);
    const double a = grid.values[grid.at(from)], b = grid.values[grid.at(to)];
    crossed[e] = (a < 0) != (b < 0);
    if (!crossed[e]) continue;
    const double t = a / (a - b);
    sums[group[e]] += (1 - t) * grid.point(from) + t * grid.point(to);
    ++counts[group[e]];
  }
  EdgeVertices vertex_of_group, vertices;
  for (int g = 0; g < 12; ++g) {
    if (counts[g] == 0) continue;
    const Eigen::Vector3d p = moved_to_surface(field, sums[g] / counts[g], grid.cell);
    vertex_of_group[g] = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(p.cast<float>());
    mesh.normals.push_back(gradient(field, p, 0.1 * grid.cell).normalized().cast<float>());
  }
  for (int e = 0; e < 12; ++e) vertices[e] = crossed[e] ? vertex_of_group[group[e]] : -1;
  return vertices;
}

// Cut along the shorter diagonal.
void add_quad(const std::array<std::uint32_t, 4>& q, TriangleMesh& mesh) {
  const auto apart = [&mesh](std::uint32_t a, std::uint32_t b) {
    return (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
  };
  const bool first = apart(q[0], q[2]) <= apart(q[1], q[3]);
  mesh.triangles.push_back({q[0], q[1], first ? q[2] : q[3]});
  mesh.triangles.push_back({first ? q[0] : q[1], q[2], q[3]});
}

}  // namespace

double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& half_size, double rounding) {
  return corner_distance<Eigen::Vector3d>(p.cwiseAbs() - half_size, rounding);
}

double rectangle_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& half_size,
                          double rounding) {
  return corner_distance<Eigen::Vector2d>(p.cwiseAbs() - half_size, rounding);
}

double capsule_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b, double radius_a, double radius_b) {
  const Eigen::Vector3d axis = b - a;
  const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - t * axis).norm() - (radius_a + t * (radius_b - radius_a));
}

double cylinder_distance(const Eigen::Vector3d& p, double radius, double half_height,
                         double rounding) {
  return rectangle_distance({p.head<2>().norm(), p.z()}, {radius, half_height}, rounding);
}

double torus_xz_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius,
                         double thickness) {
  const Eigen::Vector3d q = p - center;
  return Eigen::Vector2d(std::hypot(q.x(), q.z()) - radius, q.y()).norm() - thickness;
}

double polygon_distance(const Eigen::Vector2d& p, const Profile& corners) {
  double squared = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d edge = corners[j] - corners[i];
    const Eigen::Vector2d to_point = p - corners[i];
    const double t = std::clamp(to_point.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    squared = std::min(squared, (to_point - t * edge).squaredNorm());
    const bool straddles = (corners[i].y() > p.y()) != (corners[j].y() > p.y());
    if (straddles && p.x() < corners[i].x() + edge.x() * to_point.y() / edge.y()) {
      inside = !inside;
    }
  }
  return inside ? -std::sqrt(squared) : std::sqrt(squared);
}

Profile mirrored(const Profile& profile) {
  Profile polygon = profile;
  for (std::size_t i = profile.size(); i-- > 0;) {
    if (profile[i].x() > 0) polygon.push_back({-profile[i].x(), profile[i].y()});
  }
  return polygon;
}

double extruded(double planar_distance, double height, double half_height, double rounding) {
  return corner_distance<Eigen::Vector2d>({planar_distance, std::abs(height) - half_height},
                                          rounding);
}

double smooth_union(double a, double b, double blend) {
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - h * h * blend / 4;
}

double smooth_difference(double a, double b, double blend) { return -smooth_union(-a, b, blend); }

TriangleMesh mesh_from_field(const DistanceField& field, const Eigen::Vector3d& low,
                             const Eigen::Vector3d& high, double cell) {
  const Grid grid = sample(field, low, high, cell);
  TriangleMesh mesh;
  std::vector<int> slot_of_cell(grid.values.size(), -1);
  std::vector<EdgeVertices> slots;
  grid.for_each(1, [&](const Index& i) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      inside += grid.inside({i[0] + (c & 1), i[1] + ((c >> 1) & 1), i[2] + (c >> 2)});
    }
    if (inside == 0 || inside == 8) return;
    slot_of_cell[grid.at(i)] = static_cast<int>(slots.size());
    slots.push_back(add_vertices(grid, i, field, mesh));
  });
  // A crossed grid edge has one quad round it, through its four cubes.
  grid.for_each(1, [&](const Index& i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = next(axis, 1), v = next(axis, 2);
      if (i[u] == 0 || i[v] == 0) continue;
      Index to = i;
      ++to[axis];
      if (grid.inside(i) == grid.inside(to)) continue;
      std::array<std::uint32_t, 4> quad{};
      for (int m = 0; m < 4; ++m) {
        const int du = m == 1 || m == 2, dv = m >= 2;
        Index c = i;
        c[u] -= du;
        c[v] -= dv;
        quad[m] = slots[slot_of_cell[grid.at(c)]][4 * axis + du + 2 * dv];
      }
      if (!grid.inside(i)) std::swap(quad[1], quad[3]);
      add_quad(quad, mesh);
    }
  });
  return mesh;
}

}  // namespace bpa::sim
