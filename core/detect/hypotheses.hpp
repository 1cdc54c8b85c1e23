// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/align/correspondence.hpp"
#include "core/detect/object_trace.hpp"
#include "core/detect/scene_features.hpp"
#include "core/model/object_model.hpp"

namespace bpa {

/// A candidate pose and the correspondences that suggested it.
struct Hypothesis {
  FastPose camera_from_object;
  float score = 0;  ///< PoseCheck::score.
  /// What suggested it: an FPFH match, the votes of oriented point pairs, or the caller.
  enum class Source : std::uint8_t { feature, pairs, caller } source = Source::feature;
  int scene = -1;  ///< Scene point of the correspondence: of SceneFeatures::surface for a feature,
                   ///< of SceneFeatures::coarse for pairs, -1 for the caller;
  int model = -1;  ///< model point likewise, of ModelIndex::features or ModelIndex::coarse.
};

struct HypothesisOptions {
  int matches_per_keypoint = 2;   ///< Nearest model features of each scene keypoint.
  int draws_per_match = 3;        ///< BPA draws for each correspondence.
  int peaks_per_reference = 12;   ///< Voted model points of each scene reference point.
  int check_points = 64;          ///< Model points that a pose is checked with,
  int hidden_check_points = 512;  ///< and where few of them are in sight.
  int max_kept = 1500;            ///< Best hypotheses that go on.
  double min_check_score = 0.15;
  bool use_edges = true;        ///< Also in the correction of what is kept.
  std::vector<Pose> suggested;  ///< By the caller: looked at besides, as drawn and aligned.
  int max_suggested = 60;       ///< The best of these that go on, whatever else there is.
  std::uint64_t seed = 0;
};

/// One-correspondence poses by BPA from FPFH matches, and poses voted for by oriented point pairs;
/// those that would hang in free space or find no surface where they should are rejected (paper
/// section V). So are those that the caller suggests. Best first. `trace`, if given, receives what
/// happened on the way.
std::vector<Hypothesis> sample_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                          const HypothesisOptions& options,
                                          SamplingTrace* trace = nullptr);

/// Groups hypotheses within 2.5 cm and π/16 of one another (modulo the model's symmetry), keeps
/// groups of at least two correspondences, and aligns each group's best member again with BPA from
/// the group's correspondences (paper section V). Best first, at most `max_clusters`. Groups with a
/// member that the caller suggested take up to a quarter of these before others do. `dropped`, if
/// given, receives the poses that are in no group that is returned, and all but the first of each.
std::vector<Hypothesis> cluster_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                           const std::vector<Hypothesis>& hypotheses,
                                           int max_clusters, DroppedPoses* dropped = nullptr);

}  // namespace bpa
