// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/bpa_alignment.hpp"

#include <vector>

#include "core/align/align.hpp"
#include "core/base/random.hpp"
#include "core/detect/edge_matches.hpp"
#include "core/detect/surface_match.hpp"
#include "core/model/model_index.hpp"

namespace bpa {
namespace {

constexpr double kSigmaOfGate = 0.5;  // a correspondence's standard deviation, of the gate
constexpr int kSurfaceTries = 8, kEdgeTries = 3;  // random points for each correspondence wanted

// A random part of the super-pixels: surface that is not the object's is left out now and then.
bool segment_sampled(std::int32_t segment, double share, std::uint64_t seed) {
  return segment >= 0 && RandomStream(seed, static_cast<std::uint64_t>(segment)).uniform() < share;
}

std::vector<align::OrientedPair> surface_pairs(const SceneFeatures& scene, const ObjectModel& model,
                                               const FastPose& pose, float gate,
                                               const DetectOptions& options, RandomStream& random) {
  const std::uint64_t segment_seed = random();
  const CheckPoints& points = model.index->check;
  const auto wanted = static_cast<std::size_t>(options.round_two.max_pairs);
  std::vector<align::OrientedPair> pairs;
  SurfaceMatch match;
  for (std::size_t t = 0; t < kSurfaceTries * wanted && pairs.size() < wanted; ++t) {
    const auto i = static_cast<std::size_t>(random.index(static_cast<int>(points.points.size())));
    if (!match_surface(scene, points, i, pose, gate, match)) continue;
    if (options.align.use_segments &&
        !segment_sampled(scene.segmentation.labels[match.pixel], options.round_two.segment_share,
                         segment_seed)) {
      continue;
    }
    align::OrientedPair& pair = pairs.emplace_back();
    pair.model.point = points.points[i].cast<double>();
    pair.model.orientation = align::feature_orientation(points.normals[i].cast<double>());
    pair.scene.point = match.scene_point.cast<double>();
    pair.scene.orientation = align::feature_orientation(match.scene_normal.cast<double>());
    pair.sigma = kSigmaOfGate * static_cast<double>(gate);
  }
  return pairs;
}

std::vector<align::PositionPair> edge_pairs(const SceneFeatures& scene, const ObjectModel& model,
                                            const FastPose& pose, float gate, int count,
                                            RandomStream& random) {
  std::vector<align::PositionPair> pairs;
  const ModelView& view = nearest_view(model.index->views, pose);
  if (view.edges.empty()) return pairs;
  const auto wanted = static_cast<std::size_t>(count);
  for (int t = 0; t < kEdgeTries * count && pairs.size() < wanted; ++t) {
    const auto k = static_cast<std::size_t>(random.index(static_cast<int>(view.edges.size())));
    const EdgePoint edge = edge_point(model, view, pose, k);
    const std::optional<float> offset = match_edge(scene.image, edge, gate);
    if (!offset) continue;
    const Eigen::Vector3f observed = edge.point + *offset * edge.outward;
    pairs.push_back({model.surface.points[view.edges[k]].cast<double>(), observed.cast<double>(),
                     kSigmaOfGate * static_cast<double>(gate)});
  }
  return pairs;
}

}  // namespace

Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, std::uint64_t seed, const DetectOptions& options) {
  RandomStream random(seed, Stream::segments);
  const FastPose pose = to_fast(start);
  const auto oriented = surface_pairs(scene, model, pose, gate, options, random);
  if (oriented.size() < static_cast<std::size_t>(options.round_two.min_pairs)) return start;
  std::vector<align::PositionPair> positions;
  if (options.align.use_edges) {
    positions = edge_pairs(scene, model, pose, gate, options.round_two.max_pairs / 2, random);
  }
  align::Correspondences data;
  data.oriented = oriented;
  data.positions = positions;
  return (options.align.use_orientation ? align::bpa_mode(data) : align::icp_mode(data))
      .camera_from_object;
}

}  // namespace bpa
