// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/sim/distance_field.hpp"

// A cube's corner is three bits (x, y, z). Its edge along axis a, at offsets u and v along the next
// two axes, has number 4 a + u + 2 v.

namespace bpa::sim {
namespace {

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
};

Grid sample(const DistanceField& field, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
            double cell) {
  Grid grid;
  grid.low = low;
  grid.cell = cell;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<int>(std::ceil((high[a] - low[a]) / cell)) + 1;
  }
  grid.values.resize(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2]);
  for (int z = 0; z < grid.size[2]; ++z) {
    for (int y = 0; y < grid.size[1]; ++y) {
      for (int x = 0; x < grid.size[0]; ++x) {
        grid.values[grid.at({x, y, z})] = field(grid.point({x, y, z}));
      }
    }
  }
  return grid;
}

struct CubeEdge {
  Index from{};
  Index to{};
};

CubeEdge cube_edge(const Index& cell, int edge) {
  const int axis = edge / 4;
  CubeEdge ends{cell, cell};
  ends.from[next(axis, 1)] += edge & 1;
  ends.from[next(axis, 2)] += (edge >> 1) & 1;
  ends.to = ends.from;
  ++ends.to[axis];
  return ends;
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
        inside[m] = grid.values[grid.at(corner)] < 0;
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
    const CubeEdge ends = cube_edge(cell, e);
    const double a = grid.values[grid.at(ends.from)], b = grid.values[grid.at(ends.to)];
    crossed[e] = (a < 0) != (b < 0);
    if (!crossed[e]) continue;
    const double t = a / (a - b);
    sums[group[e]] += (1 - t) * grid.point(ends.from) + t * grid.point(ends.to);
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

void add_quad(const std::array<int, 4>& q, TriangleMesh& mesh) {
  const auto apart = [&mesh](int a, int b) {
    return (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
  };
  const auto add = [&mesh](int a, int b, int c) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                              static_cast<std::uint32_t>(c)});
  };
  if (apart(q[0], q[2]) <= apart(q[1], q[3])) {
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  } else {
    add(q[0], q[1], q[3]);
    add(q[1], q[2], q[3]);
  }
}

}  // namespace

TriangleMesh mesh_from_field(const DistanceField& field, const Eigen::Vector3d& low,
                             const Eigen::Vector3d& high, double cell) {
  const Grid grid = sample(field, low, high, cell);
  TriangleMesh mesh;
  std::vector<int> slot_of_cell(grid.values.size(), -1);
  std::vector<EdgeVertices> slots;
  const auto for_each_sample = [&grid](int trim, auto&& visit) {
    for (int z = 0; z < grid.size[2] - trim; ++z) {
      for (int y = 0; y < grid.size[1] - trim; ++y) {
        for (int x = 0; x < grid.size[0] - trim; ++x) visit(Index{x, y, z});
      }
    }
  };
  for_each_sample(1, [&](const Index& i) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      inside += grid.values[grid.at({i[0] + (c & 1), i[1] + ((c >> 1) & 1), i[2] + (c >> 2)})] < 0;
    }
    if (inside == 0 || inside == 8) return;
    slot_of_cell[grid.at(i)] = static_cast<int>(slots.size());
    slots.push_back(add_vertices(grid, i, field, mesh));
  });
  // A crossed grid edge has one quad round it, through its four cubes.
  for_each_sample(1, [&](const Index& i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = next(axis, 1), v = next(axis, 2);
      if (i[u] == 0 || i[v] == 0) continue;
      Index to = i;
      ++to[axis];
      const bool from_inside = grid.values[grid.at(i)] < 0;
      if (from_inside == (grid.values[grid.at(to)] < 0)) continue;
      std::array<int, 4> quad{};
      for (int m = 0; m < 4; ++m) {
        const int du = m == 1 || m == 2, dv = m >= 2;
        Index c = i;
        c[u] -= du;
        c[v] -= dv;
        quad[m] = slots[slot_of_cell[grid.at(c)]][4 * axis + du + 2 * dv];
      }
      if (!from_inside) std::swap(quad[1], quad[3]);
      add_quad(quad, mesh);
    }
  });
  return mesh;
}

}  // namespace bpa::sim
