// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/random_walk_score.hpp"

#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {
namespace {

struct PixelPlace {
  int u = 0, v = 0;
};

constexpr int kSteps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

bool observed(const CheckImage& image, int u, int v) {
  return u >= 0 && v >= 0 && u < image.width && v < image.height && image.depth_at(u, v) > 0;
}

std::vector<PixelPlace> explained_pixels(const CheckImage& image,
                                         const PredictedSurface& predicted) {
  std::vector<PixelPlace> places;
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    if (explains(image, u, v, z)) places.push_back({u, v});
  });
  return places;
}

PixelPlace walk(const CheckImage& image, const Image<float>& edges, PixelPlace at, int steps,
                RandomStream& random) {
  for (int k = 0; k < steps; ++k) {
    const auto& step = kSteps[random.index(4)];
    const int u = at.u + step[0], v = at.v + step[1];
    const double chance = random.uniform();  // drawn always, so that walks differ by their edges
    if (!observed(image, u, v)) continue;
    const double open = 1 - static_cast<double>(edges.at(u, v));
    if (chance < open * open) at = {u, v};
  }
  return at;
}

}  // namespace

double random_walk_score(const CheckImage& image, const Image<float>& edges,
                         const ObjectModel& model, const Pose& camera_from_object,
                         const PredictedSurface& predicted, const RandomWalkOptions& options) {
  const std::vector<PixelPlace> starts = explained_pixels(image, predicted);
  if (starts.empty() || options.walks <= 0) return -1;
  const FastPose object_from_camera = to_fast(camera_from_object.inverse());
  double sum = 0;
  for (int k = 0; k < options.walks; ++k) {
    RandomStream random(options.seed, static_cast<std::uint64_t>(k));
    const std::size_t start = (2 * static_cast<std::size_t>(k) + 1) * starts.size() /
                              (2 * static_cast<std::size_t>(options.walks));
    const PixelPlace end = walk(image, edges, starts[start], options.steps, random);
    const Eigen::Vector3f point =
        object_from_camera.rotation * observed_point(image, end.u, end.v) +
        object_from_camera.translation;
    const int nearest = model.index->distances.nearest_to(point);
    if (nearest < 0) {
      sum -= 1;
      continue;
    }
    const Eigen::Vector3f& surface = model.surface.points[static_cast<std::size_t>(nearest)];
    sum += truncated_log_normal(static_cast<double>((point - surface).norm()),
                                tolerance::kDistanceSigma);
  }
  return sum / options.walks;
}

}  // namespace bpa::score
