// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/distance_transform.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

  void transform(int n) {
    int count = 0;
    for (int q = 0; q < n; ++q) {
      const int i = q;
      if (height[i] >= kFar) continue;
      float begin = -std::numeric_limits<float>::infinity();
      while (count > 0) {
        const int v = place[count - 1];
        const float hv = height[v];
        begin = 0.5f *
                ((height[i] + static_cast<float>(q) * static_cast<float>(q)) -
                 (hv + static_cast<float>(v) * static_cast<float>(v))) /
                static_cast<float>(q - v);
        if (begin > border[count - 1]) break;
        --count;
        begin = -std::numeric_limits<float>::infinity();
      }
      place[count] = q;
      border[count] = begin;
      ++count;
    }
    if (count == 0) return;
    old_height = height;
    old_site = site;
    int k = 0;
    for (int q = 0; q < n; ++q) {
      while (k + 1 < count && border[k + 1] < static_cast<float>(q)) ++k;
      const int v = place[k];
      const auto d = static_cast<float>(q - v);
      height[q] = old_height[v] + d * d;
      site[q] = old_site[v];
    }
  }
};

// Replaces the first nearest points found by better ones that neighbouring cells know of.
void refine(std::span<const Eigen::Vector3f> points, const std::vector<std::uint32_t>& order,
            const std::vector<std::uint32_t>& first, const std::vector<std::int32_t>& site,
            DistanceTransform& t) {
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
            t.nearest[at(x, y, z)] = order[k];
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
  Line line(static_cast<std::size_t>(std::max(1, size.maxCoeff())));
  const std::size_t stride[3] = {
      1, static_cast<std::size_t>(size.x()),
      static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y())};
  for (int axis = 0; axis < 3; ++axis) {
    const int n = size[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int b = 0; b < size[v]; ++b) {
      for (int a = 0; a < size[u]; ++a) {
        const std::size_t begin =
            static_cast<std::size_t>(a) * stride[u] + static_cast<std::size_t>(b) * stride[v];
        for (int q = 0; q < n; ++q) {
          const std::size_t i = begin + static_cast<std::size_t>(q) * stride[axis];
          line.height[q] = height[i];
          line.site[q] = site[i];
        }
        line.transform(n);
        for (int q = 0; q < n; ++q) {
          const std::size_t i = begin + static_cast<std::size_t>(q) * stride[axis];
          height[i] = line.height[q];
          site[i] = line.site[q];
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
  Eigen::Vector3f low = points[0], high = points[0];
  for (const Eigen::Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  t.low = low.array() - margin;
  const Eigen::Vector3f extent = (high - low).array() + 2 * margin;
  for (t.cell = cell;; t.cell *= 1.1f) {
    t.size = (extent / t.cell).array().floor().cast<int>() + 1;
    if (t.size.cast<double>().prod() <= max_cells) break;
  }
  const std::size_t count = static_cast<std::size_t>(t.size.prod());
  // The points of each cell, by counting.
  std::vector<std::uint32_t> first(count + 1, 0);
  std::vector<std::uint8_t> marked(count, 0);
  std::vector<std::size_t> cell_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    cell_of[i] = static_cast<std::size_t>(t.cell_of(points[i]));
    ++first[cell_of[i] + 1];
    marked[cell_of[i]] = 1;
  }
  for (std::size_t c = 0; c < count; ++c) first[c + 1] += first[c];
  std::vector<std::uint32_t> order(points.size()), next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
  }
  t.nearest.assign(count, 0);
  refine(points, order, first, nearest_marked_cells(marked, t.size), t);
  return t;
}

}  // namespace bpa
