// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/base/concat.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/normals.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/model/object_model.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/private/surface_source.hpp"

namespace bpa::modeling {
namespace {

// The even surface of a cloud, by its own normals or by normals that point to the origin.
struct EvenCloud {
  PointCloud cloud;
  bool own_normals = false;
};

EvenCloud even_cloud(const PointCloud& cloud, float spacing, int num_threads) {
  PointCloud bare = cloud;
  bare.normals.clear();
  bare = downsample(bare, spacing);
  const float reach = 4 * std::max(spacing, mean_spacing(bare, -2));
  const auto estimate = [&](PointCloud& points) {
    estimate_normals(points, reach, Eigen::Vector3f::Zero(), num_threads);
  };
  const auto usable = [&](int i) { return cloud.normals[i].squaredNorm() > 0.25f; };  // not NaN
  if (!cloud.normals.empty()) {
    PointCloud even = downsample(select(cloud, usable), spacing);
    PointCloud computed = even;
    estimate(computed);
    // Cells without a usable normal are missing in one, and there twice where it is thin.
    const bool most = 5 * even.size() > 4 * bare.size();
    if (most && mend_normals(even.normals, computed.normals)) return {std::move(even), true};
  }
  estimate(bare);
  return {std::move(bare), false};
}

// Turns normals out of a closed surface: away from where it is seen. An open one is seen from both
// sides of many points: false, and it stays as it is.
bool turn_outwards(PointCloud& cloud, float spacing, int num_threads) {
  constexpr float kAside = 0.1f;                                         // cosine
  const float cell = std::max(spacing, 1.5f * mean_spacing(cloud, -2));  // few holes
  PointCloud bare;
  bare.points = cloud.points;
  struct Sides {
    int front = 0, back = 0;
  };
  std::vector<Sides> seen(cloud.size());
  for (const ModelView& view : render_views(bare, cell, num_threads)) {
    for (const std::uint32_t i : view.visible) {
      const float cosine = cloud.normals[i].dot(view.direction);
      seen[i].front += cosine > kAside;
      seen[i].back += cosine < -kAside;
    }
  }
  const auto open = std::ranges::count_if(
      seen, [](const Sides& s) { return 10 * std::min(s.front, s.back) > s.front + s.back; });
  if (5 * open > std::ssize(seen)) return false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].back > seen[i].front) cloud.normals[i] = -cloud.normals[i];
  }
  return true;
}

}  // namespace

Result<ModelSource> model_source_from_points(const PointCloud& cloud, const std::string& name,
                                             int number, const ModelOptions& options) {
  if (Status status = validate(options); !status.ok()) return status;
  if (cloud.size() < 100) {
    return invalid_argument("model ", name, " has ", cloud.size(),
                            " points; it must have at least 100");
  }
  if (Status s = check_size(name, largest_distance(cloud.points)); !s.ok()) return s;
  PointCloud bare;
  bare.points = cloud.points;
  auto spacing = static_cast<float>(options.spacing_m);
  while ((bare = downsample(bare, spacing)).size() > kMostPoints) spacing *= 1.2f;
  auto [even, own_normals] = even_cloud(cloud, spacing, options.num_threads);
  const bool complete = own_normals || turn_outwards(even, spacing, options.num_threads);
  ModelSource source = make_source(std::move(even), name, number, options.num_threads);
  source.complete = complete;
  if (spacing > static_cast<float>(options.spacing_m)) {
    source.warnings.push_back(coarse_warning(spacing));
  }
  return source;
}

}  // namespace bpa::modeling
