// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>

#include "core/align/align.hpp"
#include "core/base/random.hpp"
#include "core/detect/stages.hpp"
#include "core/features/pair_voting.hpp"
#include "core/geometry/tolerance.hpp"
#include "core/model/model_index.hpp"

namespace bpa::detect {
namespace {

// Position errors of correspondences: about the spacing of the features, and of the coarse surface.
// Depth noise is added.
constexpr double kFeatureSigma_m = tolerance::placed_m(1.6),
                 kPairSigma_m = tolerance::placed_m(3.2);
constexpr RefinementOptions kPriorAlignment{4, 100, 30, tolerance::placed_m(20),
                                            tolerance::placed_m(6)};

// One-correspondence poses by BPA from FPFH matches.
void from_features(const Search& search, Candidates& out) {
  const SampleOptions& options = search.plan.sample;
  const SceneFeatures& scene = search.scene;
  RandomStream random(search.seed + search.round, Stream::feature_draws, search.model.number);
  std::vector<features::Fpfh> fpfh;
  const std::vector<int>& keypoints = search.sample->points.keypoints;
  for (const int keypoint : keypoints) fpfh.push_back(scene.fpfh[keypoint]);
  const auto matches =
      search.model.index->feature_tree.nearest(fpfh, options.matches_per_keypoint, 1);
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (matches[k].index < 0) continue;
    if (search.late()) return;
    Candidate candidate{.model = &search.model,
                        .found_by = Source::feature,
                        .scene_point = scene.keypoints[keypoints[k / options.matches_per_keypoint]],
                        .model_point = matches[k].index};
    const align::OrientedPair pair = oriented_pair(search, candidate);
    for (int draw = 0; draw < options.draws_per_match; ++draw) {
      candidate.refinement.frame_from_object = align::bpa_sample_one(pair, random);
      out.push_back(candidate);
    }
  }
}

// Adds the poses that lay a reference point on its model point, turned as voted.
void add_voted(const Search& search, std::span<const features::VotedPose> poses, Candidates& out) {
  const PointCloud& scene = search.scene.coarse;
  const PointCloud& model = search.model.index->coarse;
  out.reserve(out.size() + poses.size());
  for (const features::VotedPose& voted : poses) {
    const int s = voted.reference, m = voted.model_point;
    FastPose pose;
    pose.rotation = features::basis_of(scene.normals[s]) *
                    Eigen::AngleAxisf(voted.turn, Eigen::Vector3f::UnitZ()) *
                    features::basis_of(model.normals[m]).transpose();
    pose.translation = scene.points[s] - pose.rotation * model.points[m];
    out.push_back({.model = &search.model,
                   .refinement = {.frame_from_object = to_pose(pose)},
                   .found_by = Source::pairs,
                   .scene_point = s,
                   .model_point = m});
  }
}

// Poses voted for by oriented point pairs (Drost et al., CVPR 2010), and by points with the rims
// of their faces.
void from_pairs(const Search& search, Candidates& out) {
  const SampleOptions& options = search.plan.sample;
  const ModelIndex& index = *search.model.index;
  features::PairColors colors;
  if (options.use_colors) colors = {search.scene.coarse_colors, index.coarse_colors, index.palette};
  const auto vote = [&](const features::ScenePairs& pairs, const features::PointPairTable& table,
                        int peaks) {
    const auto late = [&] { return search.late(); };
    const auto count = static_cast<int>(index.coarse.size());
    add_voted(search, features::vote_poses(pairs, table, count, peaks, colors, late), out);
  };
  vote(search.sample->pairs, index.pairs, options.peaks_per_reference);
  if (options.rim_peaks_per_reference > 0) {
    vote(search.sample->rim_pairs, index.rim_pairs, options.rim_peaks_per_reference);
  }
}

// A pose drawn from a prior is off by the prior's uncertainty: it is tried as drawn and aligned.
void from_priors(const Search& search, Candidates& out) {
  const SampleOptions& options = search.plan.sample;
  RandomStream random(search.seed, Stream::prior_draws, search.model.number);
  for (const Pose& pose :
       search.priors.draw(search.scene.coarse, options.draws_per_prior, random)) {
    if (search.late()) return;
    for (const Refinement& tried : {Refinement{pose}, search.refine(pose, kPriorAlignment)}) {
      out.push_back({.model = &search.model,
                     .refinement = tried,
                     .found_by = Source::prior,
                     .is_protected = true});
    }
  }
}

}  // namespace

align::OrientedPair oriented_pair(const Search& search, const Candidate& candidate) {
  const bool feature = candidate.found_by == Source::feature;
  const ModelIndex& model = *search.model.index;
  align::OrientedPair pair;
  pair.scene = align::oriented_point(feature ? search.scene.surface : search.scene.coarse,
                                     candidate.scene_point, feature);
  pair.model = align::oriented_point(feature ? model.features : model.coarse, candidate.model_point,
                                     feature);
  pair.sigma =
      (feature ? kFeatureSigma_m : kPairSigma_m) +
      static_cast<double>(search.scene.map.noise(static_cast<float>(pair.scene.point.z())));
  return pair;
}

Candidates sample(const Search& search, Candidates) {
  Candidates out;
  if (search.round == 0) from_priors(search, out);
  from_features(search, out);
  from_pairs(search, out);
  search.add_effort(&SearchEffort::sampled_poses, std::ssize(out));
  return out;
}

}  // namespace bpa::detect
