// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/posed_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/model/view_sphere.hpp"

namespace bpa::modeling {
namespace {

constexpr float kOtherSurface = 0.02f;  // metres
// Bins: their upper borders, metres and radians.
constexpr double kEdgeBorders[] = {0.001, 0.002, 0.003, 0.004, 0.005, 0.0065,
                                   0.008, 0.010, 0.015, 0.025, 0.1};
constexpr double kAngleStep = 7.5 * M_PI / 180;
constexpr int kEdgeBins = static_cast<int>(std::size(kEdgeBorders));
constexpr int kAngleBins = 12;

// Sums over the errors of one bin.
struct BinSums {
  double count = 0, edge = 0, angle = 0, squares = 0;

  void add(double e, double a, double error) {
    ++count;
    edge += e;
    angle += a;
    squares += error * error;
  }
};

using Bins = std::array<BinSums, kEdgeBins * kAngleBins>;

std::size_t bin_of(double edge, double angle) {
  int e = 0;
  while (e + 1 < kEdgeBins && edge >= kEdgeBorders[e]) ++e;
  const int a = std::clamp(static_cast<int>(angle / kAngleStep), 0, kAngleBins - 1);
  return e * kAngleBins + a;
}

// One point compared with one view.
struct Comparison {
  std::uint32_t point = 0;
  float edge_distance = 0, angle = 0;
  float range_error = 0, normal_error = -1;  // the latter negative where there is no normal
  float depth = 0;
  int pixel = 0;
};

std::vector<Comparison> compare(const PointCloud& surface, const PosedView& view, float spacing) {
  std::vector<Comparison> comparisons;
  const SurfaceMap& map = view.map;
  const FastPose pose = to_fast(view.camera_from_object);
  const ModelView expected =
      render_from(surface, -(pose.rotation.transpose() * pose.translation), spacing);
  for (std::size_t k = 0; k < expected.visible.size(); ++k) {
    const std::uint32_t i = expected.visible[k];
    const Eigen::Vector3f p = pose * surface.points[i];
    const Eigen::Vector3f n = pose.rotation * surface.normals[i];
    const Eigen::Vector2d pixel = map.camera.project(p.cast<double>());
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || v < 0 || u >= map.width() || v >= map.height()) continue;
    const int index = v * map.width() + u;
    if (!(map.depth[index] > 0) || !view.object[index]) continue;
    // The tangent plane where the pixel's ray meets it.
    const Eigen::Vector3f ray = map.camera.unproject(u, v, 1).cast<float>();
    const float along = n.dot(ray);
    const float cosine = -n.dot(p) / p.norm();
    if (cosine < 0.02f || along > -1e-3f) continue;
    const float predicted = n.dot(p) / along;
    const float error = map.depth[index] - predicted;
    if (std::abs(error) > kOtherSurface || std::abs(predicted - p.z()) > kOtherSurface) continue;
    const float angle = std::acos(std::min(1.0f, cosine));
    Comparison c{i, expected.edge_distance[k], angle, error, -1, map.depth[index], index};
    if (map.normals[index].squaredNorm() > 0.5f) {
      c.normal_error = std::acos(std::clamp(n.dot(map.normals[index]), -1.0f, 1.0f));
    }
    comparisons.push_back(c);
  }
  return comparisons;
}

std::vector<NoiseBin> to_noise_bins(const Bins& bins) {
  std::vector<NoiseBin> out;
  for (const BinSums& b : bins) {
    if (b.count < 1) continue;
    out.push_back({b.edge / b.count, b.angle / b.count, std::sqrt(b.squares / b.count), b.count});
  }
  return out;
}

// Sums over what the views say of one point, in the order of the views.
struct PointSums {
  float squared_angles = 0, color_weight = 0;
  int normals = 0, seen = 0;
  Eigen::Vector3f color = Eigen::Vector3f::Zero();

  void add(const Comparison& c, const PosedView& view) {
    constexpr float kWellSeen = 1.2f;        // radians
    constexpr float kClearOfEdges = 0.004f;  // metres: colour may lie a pixel off depth
    ++seen;
    if (c.angle < kWellSeen && c.normal_error >= 0) {
      squared_angles += c.normal_error * c.normal_error;
      ++normals;
    }
    if (view.colors.empty() || c.angle > kWellSeen) return;
    const float weight = std::cos(c.angle) * (c.edge_distance > kClearOfEdges ? 1.0f : 0.01f);
    const auto& rgb = view.colors[c.pixel];
    color += weight * Eigen::Vector3f(rgb[0], rgb[1], rgb[2]);
    color_weight += weight;
  }
};

}  // namespace

PosedView make_posed_view(const Frame& frame, const std::vector<std::uint8_t>& object,
                          const Pose& camera_from_object, const std::string& sensor) {
  const SurfaceMapOptions options{.max_range_m = 20,
                                  .max_width = std::max(1, frame.camera.width / 2),
                                  .sensor = sensor,
                                  .num_threads = 1};
  PosedView view;
  view.map = surface_map(frame, options);
  view.camera_from_object = camera_from_object;
  view.object.assign(view.map.size(), 1);
  if (!frame.color.empty()) view.colors.resize(view.map.size());
  const int r = view.map.reduction;
  for (int y = 0; y < view.map.height(); ++y) {
    for (int x = 0; x < view.map.width(); ++x) {
      const int target = y * view.map.width() + x;
      Eigen::Vector3i sum = Eigen::Vector3i::Zero();
      int count = 0, inside = 0;
      for (int v = r * y; v < std::min(r * (y + 1), frame.camera.height); ++v) {
        for (int u = r * x; u < std::min(r * (x + 1), frame.camera.width); ++u) {
          const int source = v * frame.camera.width + u;
          ++count;
          inside += object.empty() || object[source] != 0;
          if (frame.color.empty()) continue;
          for (int c = 0; c < 3; ++c) sum[c] += frame.color[3 * source + c];
        }
      }
      if (count == 0) continue;
      view.object[target] = 2 * inside > count;
      for (int c = 0; c < 3 && !frame.color.empty(); ++c) {
        view.colors[target][c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
      }
    }
  }
  return view;
}

SurfaceObservations observe_surface(const PointCloud& surface, const std::vector<PosedView>& views,
                                    int num_threads) {
  // Of the buffers that say what is hidden; without holes.
  const float spacing = std::max(0.003f, 1.1f * mean_spacing(surface, -2));
  std::vector<std::vector<Comparison>> comparisons(views.size());
  parallel_for(views.size(), num_threads,
               [&](std::size_t i) { comparisons[i] = compare(surface, views[i], spacing); });
  std::vector<PointSums> sums(surface.size());
  Bins range{}, normal{};
  double depth = 0, count = 0;
  bool colored = !views.empty();
  for (std::size_t v = 0; v < views.size(); ++v) {
    colored = colored && !views[v].colors.empty();
    for (const Comparison& c : comparisons[v]) {
      const double e = c.edge_distance, a = c.angle;
      range[bin_of(e, a)].add(e, a, c.range_error);
      if (c.normal_error >= 0) normal[bin_of(e, a)].add(e, a, c.normal_error);
      depth += c.depth;
      ++count;
      sums[c.point].add(c, views[v]);
    }
  }
  SurfaceObservations out;
  out.depth = count > 0 ? depth / count : 0;
  out.range_bins = to_noise_bins(range);
  out.normal_bins = to_noise_bins(normal);
  for (const PointSums& point : sums) {
    out.seen.push_back(point.seen);
    out.normal_variance.push_back(point.normals > 0 ? point.squared_angles / point.normals : 0);
    if (!colored) continue;
    auto& rgb = out.colors.emplace_back(std::array<std::uint8_t, 3>{});
    for (int c = 0; c < 3 && point.color_weight > 0; ++c) {
      rgb[c] =
          static_cast<std::uint8_t>(std::clamp(point.color[c] / point.color_weight, 0.0f, 255.0f));
    }
  }
  return out;
}

void learn_noise(ModelSource& source, const std::vector<PosedView>& views, int num_threads) {
  const SurfaceObservations seen = observe_surface(source.surface, views, num_threads);
  const NoiseModel usual = usual_noise();
  source.noise = usual;
  if (seen.depth > 0) {
    // The usual curves at the depth of the views are where the fit starts.
    NoiseCurve start = usual.range;
    const double scale = usual.range_sigma(0, 0, seen.depth) / usual.range(0, 0);
    start.floor *= scale, start.edge_height *= scale, start.angle_height *= scale;
    source.noise.depth = seen.depth;
    source.noise.range = fit_noise_curve(seen.range_bins, start);
    source.noise.normal = fit_noise_curve(seen.normal_bins, usual.normal);
    source.noise.fitted = true;
  }
  const std::vector<float> geometric = geometric_normal_variance(source.surface, num_threads);
  source.normal_variance.resize(seen.seen.size(), 0);
  std::size_t never = 0;
  for (std::size_t i = 0; i < seen.seen.size(); ++i) {
    never += seen.seen[i] == 0;
    float& variance = source.normal_variance[i];
    if (!(variance > 0)) variance = seen.normal_variance[i];
    const auto floor = static_cast<float>(source.noise.normal.floor);
    if (!(variance > 0)) variance = geometric[i] + floor * floor;
  }
  if (source.surface.colors.empty()) source.surface.colors = seen.colors;
  const double share = static_cast<double>(never) / seen.seen.size();
  if (share > 0.03) {
    source.warnings.push_back(concat(
        std::lround(100 * share),
        " % of the surface was measured in no view: too thin, too deep inside, or out of sight"));
  }
}

}  // namespace bpa::modeling
