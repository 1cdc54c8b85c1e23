// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <bpa/core/align/correspondence.hpp>
#include <bpa/core/detect/scene_features.hpp>
#include <bpa/core/model/object_model.hpp>

namespace bpa {

/// A candidate pose and the correspondences that suggested it.
struct Hypothesis {
  FastPose camera_from_object;
  float score = 0;  ///< PoseCheck::score.
  /// Scene point and model point: of the feature clouds when `second_scene` is -1 (one FPFH
  /// correspondence), else of the coarse clouds (a pair of oriented points).
  int scene = -1, model = -1;
  int second_scene = -1, second_model = -1;
};

struct HypothesisOptions {
  int matches_per_keypoint = 2;   ///< Nearest model features of each scene keypoint.
  int draws_per_match = 3;        ///< BPA draws for each correspondence.
  int pair_draws = 12000;         ///< Scene point pairs looked up.
  int max_matches_per_pair = 12;  ///< Model pairs tried for each of them.
  int check_points = 64;          ///< Model points that a pose is checked with.
  int max_kept = 1500;            ///< Best hypotheses that go on.
  double min_check_score = 0.25;
  std::uint64_t seed = 0;
};

/// One-correspondence poses by BPA from FPFH matches, and two-point poses from oriented pairs;
/// those that would hang in free space or find no surface where they should are rejected (paper
/// section V). Best first.
std::vector<Hypothesis> sample_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                          const HypothesisOptions& options);

/// Groups hypotheses within 2.5 cm and π/16 of one another (modulo the model's symmetry), keeps
/// groups of at least two correspondences, and aligns each group's best member again with BPA from
/// the group's correspondences (paper section V). Best first, at most `max_clusters`.
std::vector<Hypothesis> cluster_hypotheses(const SceneFeatures& scene, const ObjectModel& model,
                                           const std::vector<Hypothesis>& hypotheses,
                                           int max_clusters);

}  // namespace bpa
