// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/segment_scores.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/model_index.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {
namespace {

constexpr double kAffinityFloor = 0.02;

// What the points of one segment say.
void judge(const segment::Segment& segment, const SurfaceMap& map, const ObjectModel& model,
           const FastPose& object_from_camera, const SegmentMatchOptions& options,
           SegmentMatch& match) {
  const auto wanted = static_cast<std::size_t>(std::max(1, options.points));
  const std::size_t count = std::min(wanted, segment.pixels.size());
  const auto min_cosine = static_cast<float>(std::cos(options.max_angle));
  double distances = 0;
  int on_model = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t pixel = segment.pixels[(2 * k + 1) * segment.pixels.size() / (2 * count)];
    const Eigen::Vector3f point = object_from_camera * map.points[pixel];
    const int nearest = model.index->distances.nearest_to(point);
    if (nearest < 0) {
      distances -= 1;
      continue;
    }
    const auto i = static_cast<std::size_t>(nearest);
    const float distance = (point - model.surface.points[i]).norm();
    const Eigen::Vector3f normal = object_from_camera.rotation * map.normals[pixel];
    const float cosine =
        std::max(normal.dot(model.surface.normals[i]), normal.dot(model.index->soft_normals[i]));
    distances += truncated_log_normal(static_cast<double>(distance), tolerance::kDistanceSigma);
    on_model +=
        distance < tolerance::kOnSurface(map.noise(map.depth[pixel])) && cosine > min_cosine;
  }
  match.distance = distances / static_cast<double>(count);
  match.probability = static_cast<double>(on_model) / static_cast<double>(count);
}

// Of each segment, the number of pixels that are about where they are predicted.
std::vector<int> touched_pixels(const segment::Segmentation& segmentation, const SurfaceMap& map,
                                const PredictedSurface& predicted) {
  std::vector<int> touched(segmentation.segments.size(), 0);
  predicted.for_each([&](int u, int v, float z, std::uint32_t) {
    const std::size_t i = segmentation.labels.index(u, v);
    if (segmentation.labels[i] < 0 ||
        std::abs(map.depth[i] - z) > tolerance::kFollowed(map.noise(z)))
      return;
    ++touched[static_cast<std::size_t>(segmentation.labels[i])];
  });
  return touched;
}

}  // namespace

std::vector<SegmentMatch> match_segments(const segment::Segmentation& segmentation,
                                         const SurfaceMap& map, const ObjectModel& model,
                                         const Pose& camera_from_object,
                                         const PredictedSurface& predicted,
                                         const SegmentMatchOptions& options) {
  const FastPose object_from_camera = to_fast(camera_from_object.inverse());
  std::vector<SegmentMatch> matches;
  const std::vector<int> touched = touched_pixels(segmentation, map, predicted);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (touched[i] == 0) continue;
    SegmentMatch& match =
        matches.emplace_back(SegmentMatch{.segment = static_cast<int>(i), .explained = touched[i]});
    judge(segmentation.segments[i], map, model, object_from_camera, options, match);
  }
  return matches;
}

double segment_score(const std::vector<SegmentMatch>& matches) {
  double sum = 0, weights = 0;
  for (const SegmentMatch& match : matches) {
    sum += match.explained * match.distance;
    weights += match.explained;
  }
  return weights > 0 ? sum / weights : -1;
}

double segment_affinity_score(const segment::Segmentation& segmentation,
                              const std::vector<SegmentMatch>& matches) {
  std::vector<double> probability(segmentation.segments.size(), 0);
  for (const SegmentMatch& match : matches) {
    probability[static_cast<std::size_t>(match.segment)] = match.probability;
  }
  double sum = 0, weights = 0;
  for (const segment::SegmentPair& pair : segmentation.pairs) {
    const double first = probability[static_cast<std::size_t>(pair.first)];
    const double second = probability[static_cast<std::size_t>(pair.second)];
    if (first + second == 0) continue;
    const double both = first * second, one = first + second - 2 * both;
    const auto affinity = static_cast<double>(pair.affinity);
    sum += pair.contact * (both * truncated_log(affinity, kAffinityFloor) +
                           one * truncated_log(1 - affinity, kAffinityFloor));
    weights += pair.contact * (both + one);
  }
  return weights > 0 ? sum / weights : -1;
}

}  // namespace bpa::score
