// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/cloud/neighbor_grid.hpp"
#include "core/modeling/posed_view.hpp"
#include "core/modeling/trace_occupancy.hpp"

namespace bpa {
namespace {

constexpr float kLeastCell = 0.003f;  // metres
constexpr std::size_t kFewest = 100;  // points that a model needs
constexpr double kMuchUnseen = 0.03;  // share of the surface
constexpr float kSameSide = 0.5f;     // cosine between normals

// How large a pixel is on the object, and how far it is, on average.
struct Resolution {
  float pixel = 0, depth = 0;  // metres
};

Resolution resolution_of(const std::vector<PosedView>& views) {
  double pixels = 0, depths = 0, count = 0;
  for (const PosedView& view : views) {
    for (std::size_t i = 0; i < view.map.size(); ++i) {
      if (!view.object[i] || !(view.map.depth[i] > 0)) continue;
      const auto z = static_cast<double>(view.map.depth[i]);
      pixels += z / view.map.camera.fx;
      depths += z;
      ++count;
    }
  }
  if (!(count > 0)) return {};
  return {static_cast<float>(pixels / count), static_cast<float>(depths / count)};
}

// For each point of the surface, the normal variance that the measured sheet beside it gives; -1
// where there is none.
std::vector<float> measured_variance(const PointCloud& surface, const GridSurface& measured,
                                     float reach, float most_off) {
  const NeighborGrid near(measured.points.points, reach);
  std::vector<float> out(surface.size(), -1);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f &p = surface.points[i], &n = surface.normals[i];
    float sum = 0, total = 0;
    near.for_each_neighbor(p, [&](int neighbor, float squared) {
      const auto j = static_cast<std::size_t>(neighbor);
      const float cosine = n.dot(measured.points.normals[j]);
      if (cosine < kSameSide || std::abs(n.dot(measured.points.points[j] - p)) > most_off) return;
      const float bias = std::acos(std::min(1.0f, cosine));
      const float weight = 1.0001f - squared / (reach * reach);
      sum += weight * (measured.normal_variance[j] + bias * bias);
      total += weight;
    });
    if (total > 0) out[i] = sum / total;
  }
  return out;
}

void keep(ModelSource& source, const std::vector<float>& variance) {
  PointCloud& cloud = source.surface;
  std::size_t kept = 0;
  source.normal_variance.clear();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (variance[i] < 0) continue;
    cloud.points[kept] = cloud.points[i];
    cloud.normals[kept] = cloud.normals[i];
    if (!cloud.colors.empty()) cloud.colors[kept] = cloud.colors[i];
    source.normal_variance.push_back(variance[i]);
    ++kept;
  }
  cloud.points.resize(kept);
  cloud.normals.resize(kept);
  if (!cloud.colors.empty()) cloud.colors.resize(kept);
}

}  // namespace

void keep_measured(ModelSource& source, const std::vector<PosedView>& views, int num_threads) {
  const Resolution resolution = resolution_of(views);
  auto grid = std::make_shared<OccupancyGrid>(
      trace_occupancy(views, std::max(kLeastCell, resolution.pixel), num_threads));
  const GridSurface measured = surface_of(*grid, grid->cell, num_threads);
  const float most_off = std::max(0.004f, 3 * depth_noise(resolution.depth));
  const std::vector<float> variance =
      measured_variance(source.surface, measured, 2.2f * grid->cell, most_off);
  const auto unseen = static_cast<std::size_t>(
      std::count_if(variance.begin(), variance.end(), [](float v) { return v < 0; }));
  const double share = static_cast<double>(unseen) / static_cast<double>(variance.size());
  source.occupancy = std::move(grid);
  if (source.surface.size() - unseen < kFewest) {
    source.warnings.push_back(
        "a sensor hardly sees it: too small, too thin or too dark; the whole "
        "surface is kept");
  } else {
    if (share > kMuchUnseen) {
      source.warnings.push_back(std::to_string(std::lround(100 * share)) +
                                " % of the surface was measured in no view and was left out");
    }
    keep(source, variance);
    source.diameter = largest_distance(source.surface.points);
  }
  learn_noise(source, views, num_threads);
}

}  // namespace bpa
