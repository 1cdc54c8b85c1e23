// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "core/align/align.hpp"
#include "core/base/random.hpp"
#include "core/detect/matches.hpp"
#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa::detect {
namespace {

constexpr std::ptrdiff_t kMinPairs = 4;  // with fewer the pose stays
constexpr double kSegmentShare = 0.7;    // of the super-pixels that one alignment uses
constexpr float kFirstGate_m = tolerance::placed(12),
                kGateDecay = 0.8f;  // of correspondences, step by step
constexpr int kCheckPoints = 300;   // that proposals are compared with
constexpr score::CheckTolerance kTolerance{tolerance::placed_m(3.2), tolerance::placed_m(8), 0.8};
constexpr RefinementOptions kLastProposal{4, 160, 60, tolerance::placed_m(10),
                                          tolerance::placed_m(4.8)};

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
  const int wanted = options.round_two.max_pairs;
  std::vector<align::OrientedPair> pairs;
  SurfaceMatch match;
  for (int t = 0; t < kSurfaceTries * wanted && std::ssize(pairs) < wanted; ++t) {
    const int i = random.index(static_cast<int>(points.points.size()));
    if (!match_surface(scene, points, i, pose, gate, match)) continue;
    if (options.align.use_segments &&
        !segment_sampled(scene.segmentation.labels[match.pixel], kSegmentShare, segment_seed)) {
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
  for (int t = 0; t < kEdgeTries * count && std::ssize(pairs) < count; ++t) {
    const int k = random.index(static_cast<int>(view.edges.size()));
    const EdgePoint edge = edge_point(view_edge(model, view, k), pose);
    const std::optional<float> offset = match_edge(scene.image, edge, gate);
    if (!offset) continue;
    const Eigen::Vector3f observed = edge.point + *offset * edge.outward;
    pairs.push_back({model.surface.points[view.edges[k]].cast<double>(), observed.cast<double>(),
                     kSigmaOfGate * static_cast<double>(gate)});
  }
  return pairs;
}

// Proposes alignments; each is accepted if the check score improves.
Pose aligned(const Search& search, const Pose& start) {
  const RoundTwoOptions& options = search.plan.round_two;
  const auto check_score = [&](const Pose& pose) {
    return search.check(pose, {kCheckPoints}, kTolerance).score();
  };
  Pose best = start;
  float best_score = check_score(start);
  const auto propose = [&](const Pose& pose) {
    const float score = check_score(pose);
    if (score > best_score) {
      best = pose;
      best_score = score;
    }
  };
  auto gate = kFirstGate_m;
  for (int step = 0; step < options.bpa_steps; ++step) {
    search.add_effort(&SearchEffort::alignments);
    propose(align_to_surface(search.scene, search.model, best, gate,
                             search.seed + static_cast<std::uint64_t>(step), search.plan));
    gate *= kGateDecay;
  }
  propose(search.aligned(best, kLastProposal));
  return best;
}

}  // namespace

Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, std::uint64_t seed, const DetectOptions& options) {
  RandomStream random(seed, Stream::segments);
  const FastPose pose = to_fast(start);
  const auto oriented = surface_pairs(scene, model, pose, gate, options, random);
  if (std::ssize(oriented) < kMinPairs) return start;
  std::vector<align::PositionPair> positions;
  if (options.align.use_edges) {
    positions = edge_pairs(scene, model, pose, gate, options.round_two.max_pairs / 2, random);
  }
  const align::Correspondences data{.oriented = oriented, .positions = positions};
  return (options.align.use_orientation ? align::bpa_mode(data) : align::icp_mode(data))
      .camera_from_object;
}

Candidates round_two(const Search& search, Candidates clusters) {
  change_each(search, clusters, [&](Candidate& candidate) {
    candidate.refinement.frame_from_object = aligned(search, candidate.pose());
    candidate.score = search.quick_score(candidate.pose());
  });
  suppress_duplicates(search, clusters);
  return clusters;
}

}  // namespace bpa::detect
