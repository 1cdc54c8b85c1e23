// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/posed_view.hpp"
#include "core/modeling/trace_occupancy.hpp"

namespace bpa::modeling {
namespace {

constexpr float kLeastCell = 0.003f;  // metres
constexpr std::size_t kFewest = 100;  // points that a model needs
constexpr double kMuchUnseen = 0.03;  // share of the surface
constexpr float kSameSurface = 0.5f;  // cosine between normals

// How large a pixel is on the object, and how far it is, on average, in metres.
std::pair<double, double> pixel_and_depth(const std::vector<PosedView>& views) {
  double pixels = 0, depths = 0, count = 0;
  for (const PosedView& view : views) {
    for (std::size_t i = 0; i < view.map.size(); ++i) {
      if (!view.object[i] || !(view.map.depth[i] > 0)) continue;
      pixels += view.map.depth[i] / view.map.camera.fx;
      depths += view.map.depth[i];
      ++count;
    }
  }
  return {pixels / std::max(1.0, count), depths / std::max(1.0, count)};
}

// For each point of the surface, the normal variance of the measured sheet beside it; -1: none.
std::vector<float> measured_variance(const PointCloud& surface, const GridSurface& measured,
                                     float reach, float most_off) {
  const NeighborGrid near(measured.points.points, reach);
  std::vector<float> out(surface.size(), -1);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f &p = surface.points[i], &n = surface.normals[i];
    float sum = 0, total = 0;
    near.for_each_neighbor(p, [&](int j, float squared) {
      const float cosine = n.dot(measured.points.normals[j]);
      if (cosine < kSameSurface || std::abs(n.dot(measured.points.points[j] - p)) > most_off)
        return;
      const float bias = std::acos(std::min(1.0f, cosine));
      const float weight = 1.0001f - squared / (reach * reach);
      sum += weight * (measured.normal_variance[j] + bias * bias);
      total += weight;
    });
    if (total > 0) out[i] = sum / total;
  }
  return out;
}

// The share of the object's outline, over all view angles, where one looks at the back of the
// surface: through a part that was never seen; and in the view from the worst `direction` alone.
struct Unseen {
  double share = 0, worst = 0;
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();
};

Unseen unseen_part(const PointCloud& surface, int num_threads) {
  // Both sides compete for being seen.
  PointCloud both;
  for (const float side : {1.0f, -1.0f}) {
    both.points.insert(both.points.end(), surface.points.begin(), surface.points.end());
    for (const Eigen::Vector3f& n : surface.normals) both.normals.emplace_back(side * n);
  }
  // The back of a wall is not to be seen where its other side is there too.
  constexpr float kThickest = 0.010f;  // metres
  const NeighborGrid grid(surface.points, kThickest);
  std::vector<std::uint8_t> backed(surface.size(), 0);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    grid.for_each_neighbor(surface.points[i], [&](int j, float) {
      backed[i] |= surface.normals[j].dot(surface.normals[i]) < -0.3f;
    });
  }
  const auto views = render_views(both, 0.004f, num_threads);
  Unseen out;
  double front = 0, back = 0;
  for (const ModelView& view : views) {
    double own_front = 0, own_back = 0;
    for (const std::uint32_t i : view.visible) {
      const double area = both.normals[i].dot(view.direction);
      if (area < 0.3) continue;
      if (i >= surface.size() && backed[i - surface.size()]) continue;
      (i < surface.size() ? own_front : own_back) += area;
    }
    front += own_front;
    back += own_back;
    const double share = own_back / std::max(1e-9, own_front + own_back);
    if (share <= out.worst) continue;
    out.worst = share;
    out.direction = view.direction;
  }
  out.share = back / std::max(1e-9, front + back);
  return out;
}

std::string name_of(const Eigen::Vector3f& d) {
  Eigen::Index axis = 0;
  d.cwiseAbs().maxCoeff(&axis);
  static constexpr const char* kNames[3][2] = {{"-x", "+x"}, {"-y", "+y"}, {"-z", "+z"}};
  return kNames[axis][d[axis] > 0 ? 1 : 0];
}

}  // namespace

Result<ModelSource> model_source_from_views(std::vector<PosedView> views, const std::string& name,
                                            int number, const ModelOptions& options) {
  if (Status status = validate(options); !status.ok()) return status;
  const auto spacing = static_cast<float>(options.spacing_m);
  const auto grid =
      std::make_shared<OccupancyGrid>(trace_occupancy(views, spacing, options.num_threads));
  GridSurface fused = surface_of(*grid, spacing, options.num_threads);
  if (fused.points.size() < 100) {
    return invalid_argument("model ", name, " has ", fused.points.size(), " surface points in ",
                            views.size(), " views; it must have at least 100");
  }
  ModelSource source;
  source.name = name;
  source.number = number;
  source.surface = std::move(fused.points);
  source.normal_variance = std::move(fused.normal_variance);
  source.occupancy = grid;
  source.diameter = largest_distance(source.surface.points);
  if (Status s = check_size(name, source.diameter); !s.ok()) return s;
  source.warnings = shape_warnings(source.surface);
  learn_noise(source, views, options.num_threads);
  // Little of the whole, but most of what one sees from one side: the floor inside of a mug.
  constexpr double kMuch = 0.04, kMuchOfOneView = 0.3;
  const Unseen unseen = unseen_part(source.surface, options.num_threads);
  if (unseen.share > kMuch || unseen.worst > kMuchOfOneView) {
    source.warnings.push_back(concat("about ", std::lround(100 * unseen.share),
                                     " % of the object was never seen, most of it from ",
                                     name_of(unseen.direction),
                                     ": scan it in one more resting position"));
  }
  return source;
}

void center_object(std::vector<PosedView>& views) {
  Eigen::AlignedBox3d box;
  for (const PosedView& view : views) {
    const Pose object_from_camera = view.camera_from_object.inverse();
    for (std::size_t i = 0; i < view.map.size(); i += 3) {
      if (!view.object[i] || !(view.map.depth[i] > 0)) continue;
      box.extend(object_from_camera * view.map.points[i].cast<double>());
    }
  }
  if (box.isEmpty()) return;
  const Pose old_from_new{Eigen::Quaterniond::Identity(), box.center()};
  for (PosedView& view : views) view.camera_from_object = view.camera_from_object * old_from_new;
}

void keep_measured(ModelSource& source, const std::vector<PosedView>& views, int num_threads) {
  const auto [pixel, depth] = pixel_and_depth(views);
  auto grid = std::make_shared<OccupancyGrid>(
      trace_occupancy(views, std::max<float>(kLeastCell, pixel), num_threads));
  const GridSurface measured = surface_of(*grid, grid->cell, num_threads);
  const float most_off = std::max(0.004f, 3 * depth_noise(depth));
  const std::vector<float> variance =
      measured_variance(source.surface, measured, 2.2f * grid->cell, most_off);
  const auto unseen = std::ranges::count_if(variance, [](float v) { return v < 0; });
  const double share = static_cast<double>(unseen) / variance.size();
  source.occupancy = std::move(grid);
  if (variance.size() - unseen < kFewest) {
    source.warnings.push_back(
        "a sensor hardly sees it: too small, too thin or too dark; the whole "
        "surface is kept");
  } else {
    if (share > kMuchUnseen) {
      source.warnings.push_back(std::to_string(std::lround(100 * share)) +
                                " % of the surface was measured in no view and was left out");
    }
    source.surface = select(source.surface, [&](int i) { return variance[i] >= 0; });
    source.normal_variance = variance;
    std::erase_if(source.normal_variance, [](float v) { return v < 0; });
    source.diameter = largest_distance(source.surface.points);
  }
  learn_noise(source, views, num_threads);
}

}  // namespace bpa::modeling
