// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/boundary_scores.hpp"

#include <algorithm>

#include "core/score/likelihood.hpp"

namespace bpa::score {
namespace {

constexpr double kEdgeFloor = 0.05;          // least likelihood of an edge where one is predicted
constexpr std::size_t kMaxEdgePoints = 300;  // that are looked at

// The largest edge likelihood between a point and the place `reach` from it.
double best_edge(const CheckImage& image, const Image<float>& edges, const Eigen::Vector3f& point,
                 const Eigen::Vector3f& reach) {
  float best = 0;
  for (const float part : {0.0f, 0.5f, 1.0f}) {
    const int pixel = image.pixel_of(point + part * reach);
    if (pixel >= 0) best = std::max(best, edges[static_cast<std::size_t>(pixel)]);
  }
  return static_cast<double>(best);
}

}  // namespace

double edge_likelihood_score(const CheckImage& image, const Image<float>& edges,
                             const ObjectModel& model, const Pose& camera_from_object) {
  if (!model.complete) return 0;
  const FastPose pose = to_fast(camera_from_object);
  const ModelView& view = nearest_view(model.index->views, pose);
  const std::size_t step = std::max<std::size_t>(1, view.edges.size() / kMaxEdgePoints);
  double sum = 0, weights = 0;
  for (std::size_t k = 0; k < view.edges.size(); k += step) {
    const Eigen::Vector3f point = pose * model.surface.points[view.edges[k]];
    const int pixel = image.pixel_of(point);
    if (pixel < 0) continue;
    const float observed = image.pixels[static_cast<std::size_t>(pixel)].depth;
    const double weight = visibility_probability(double{observed}, double{point.z()});
    const Eigen::Vector3f reach = tolerance::kBesideEdge * (pose.rotation * view.outward[k]);
    sum += weight * truncated_log(best_edge(image, edges, point, reach), kEdgeFloor);
    weights += weight;
  }
  return weights > 0.5 ? sum / weights : -1;
}

double occlusion_edge_score(const CheckImage& image, const Image<float>& edges,
                            const PredictedSurface& predicted) {
  const auto occluded = [&](int u, int v, float z) { return image.hides(image.depth_at(u, v), z); };
  double sum = 0;
  int count = 0;
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    const bool hidden = occluded(u, v, z);
    for (const auto& [x, y] : {std::pair(u + 1, v), std::pair(u, v + 1)}) {
      const float next = predicted.depth_at(x, y);
      if (next <= 0 || occluded(x, y, next) == hidden) continue;
      sum +=
          truncated_log(static_cast<double>(std::max(edges.at(u, v), edges.at(x, y))), kEdgeFloor);
      ++count;
    }
  });
  return count > 0 ? sum / count : 0;
}

}  // namespace bpa::score
