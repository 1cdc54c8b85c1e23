// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/distance_transform.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

namespace bpa {
namespace {

constexpr float kFar = 1e18f;

// The lower envelope of the parabolas height[k] + (x - k)^2 over one line, in place; `site` follows
// the parabola that is lowest.
struct Line {
  std::vector<float> height;
  std::vector<std::int32_t> site;
  std::vector<int> place;     // of the parabolas in the envelope
  std::vector<float> border;  // where each begins
  std::vector<float> old_height;
  std::vector<std::int32_t> old_site;

  explicit Line(std::size_t n)
      : height(n), site(n), place(n), border(n + 1), old_height(n), old_site(n) {}

  // Where the parabola of q begins to be lower than that of v < q.
  float crossing(int v, int q) const {
    const float at_q = q, at_v = v;
    return 0.5f * ((height[q] + at_q * at_q) - (height[v] + at_v * at_v)) / (at_q - at_v);
  }

  void transform(int n) {
    int count = 0;
    for (int q = 0; q < n; ++q) {
      if (height[q] >= kFar) continue;
      float begin = -std::numeric_limits<float>::infinity();
      for (; count > 0; --count) {
        begin = crossing(place[count - 1], q);
        if (begin > border[count - 1]) break;
        begin = -std::numeric_limits<float>::infinity();
      }
      place[count] = q;
      border[count++] = begin;
    }
    if (count == 0) return;
    old_height = height;
    old_site = site;
    int k = 0;
    for (int q = 0; q < n; ++q) {
      while (k + 1 < count && border[k + 1] < q) ++k;
      const float d = q - place[k];
      height[q] = old_height[place[k]] + d * d;
      site[q] = old_site[place[k]];
    }
  }
};

// For each cell of the grid, the nearest point of those that it and the neighbouring cells found.
std::vector<std::uint32_t> refined(std::span<const Eigen::Vector3f> points,
                                   const std::vector<std::uint32_t>& order,
                                   const std::vector<std::uint32_t>& first,
                                   const std::vector<std::int32_t>& site,
                                   const DistanceTransform& t) {
  std::vector<std::uint32_t> nearest(site.size(), 0);
  const int nx = t.size.x(), ny = t.size.y(), nz = t.size.z();
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        const auto at = [&](int i, int j, int k) {
          return static_cast<std::size_t>((k * ny + j) * nx + i);
        };
        const Eigen::Vector3f centre =
            t.low + t.cell * (Eigen::Vector3i(x, y, z).cast<float>().array() + 0.5f).matrix();
        float best = std::numeric_limits<float>::infinity();
        const auto consider = [&](std::size_t neighbour) {
          const int s = site[neighbour];
          for (std::uint32_t k = first[s]; k < first[s + 1]; ++k) {
            const float squared = (points[order[k]] - centre).squaredNorm();
            if (squared >= best) continue;
            best = squared;
            nearest[at(x, y, z)] = order[k];
          }
        };
        consider(at(x, y, z));
        if (x > 0) consider(at(x - 1, y, z));
        if (x + 1 < nx) consider(at(x + 1, y, z));
        if (y > 0) consider(at(x, y - 1, z));
        if (y + 1 < ny) consider(at(x, y + 1, z));
        if (z > 0) consider(at(x, y, z - 1));
        if (z + 1 < nz) consider(at(x, y, z + 1));
      }
    }
  }
  return nearest;
}

}  // namespace

std::vector<std::int32_t> nearest_marked_cells(const std::vector<std::uint8_t>& marked,
                                               const Eigen::Vector3i& size) {
  const std::size_t count = marked.size();
  std::vector<std::int32_t> site(count, -1);
  std::vector<float> height(count, kFar);
  for (std::size_t i = 0; i < count; ++i) {
    if (!marked[i]) continue;
    site[i] = static_cast<std::int32_t>(i);
    height[i] = 0;
  }
  Line line(std::max(1, size.maxCoeff()));
  const std::size_t width = size.x(), layer = width * size.y(), stride[3] = {1, width, layer};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int b = 0; b < size[v]; ++b) {
      for (int a = 0; a < size[u]; ++a) {
        const std::size_t begin = a * stride[u] + b * stride[v];
        for (int q = 0; q < size[axis]; ++q) {
          line.height[q] = height[begin + q * stride[axis]];
          line.site[q] = site[begin + q * stride[axis]];
        }
        line.transform(size[axis]);
        for (int q = 0; q < size[axis]; ++q) {
          height[begin + q * stride[axis]] = line.height[q];
          site[begin + q * stride[axis]] = line.site[q];
        }
      }
    }
  }
  return site;
}

DistanceTransform distance_transform(std::span<const Eigen::Vector3f> points, float cell,
                                     float margin, int max_cells) {
  DistanceTransform t;
  if (points.empty()) return t;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  t.low = box.min().array() - margin;
  const Eigen::Vector3f extent = box.sizes().array() + 2 * margin;
  for (t.cell = cell;; t.cell *= 1.1f) {
    t.size = (extent / t.cell).array().floor().cast<int>() + 1;
    if (t.size.cast<double>().prod() <= max_cells) break;
  }
  const std::size_t count = t.size.prod();
  std::vector<std::uint32_t> first(count + 1, 0);
  std::vector<std::uint8_t> marked(count, 0);
  for (const Eigen::Vector3f& p : points) {
    ++first[t.cell_of(p) + 1];
    marked[t.cell_of(p)] = 1;
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return t.cell_of(points[i]); });
  t.nearest = refined(points, order, first, nearest_marked_cells(marked, t.size), t);
  return t;
}

}  // namespace bpa
