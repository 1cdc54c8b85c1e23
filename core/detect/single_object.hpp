// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/detect/hypotheses.hpp"
#include "core/detect/object_trace.hpp"
#include "core/detect/pose_prior.hpp"
#include "core/detect/refinement.hpp"
#include "core/result/placement.hpp"
#include "core/score/feature_score.hpp"
#include "core/score/score_layer.hpp"

namespace bpa {

/// One model at one pose, scored, before it is known what else is in the scene.
struct Candidate {
  std::shared_ptr<const ObjectModel> model;
  Refinement refinement;  ///< The pose and what the last alignment knew of it.
  ScoreComponents components;
  double prior = 0;        ///< Log odds that the caller's priors add; 0 without any.
  double score = 0;        ///< placement_score of the components, and the priors: log odds.
  double probability = 0;  ///< Of that score, without rivals.
  std::vector<std::uint32_t> explained;  ///< Sorted pixels of the reduced image on the model.

  const Pose& pose() const { return refinement.camera_from_object; }
};

/// Two placements of one model that are nearer than this, in diameters, claim the same place.
constexpr double kSamePlace = 0.4;

constexpr int kQuickPoints = 200;  ///< Surface points that round two scores a placement with.

struct SingleObjectOptions {
  HypothesisOptions hypotheses;
  int max_clusters = 200;         ///< Pose clusters that round two looks at.
  int max_refined = 40;           ///< Of those, how many are aligned to the end.
  int max_climbed = 8;            ///< The best of these climb the score at last.
  int climb_rounds = 4;           ///< Rounds of twelve small steps each.
  int max_turned = 6;             ///< The best of these are also tried turned by near symmetries.
  int max_kept_turned = 12;       ///< Of these turns, how many are aligned to the end.
  int bpa_steps = 3;              ///< Round-two alignments by BPA.
  bool use_orientation = true;    ///< See AlignmentCues; likewise
  bool use_segments = true;       ///< this
  bool use_edges = true;          ///< and this, which also goes for gradient-based alignment.
  bool use_round_three = true;    ///< False: the components of round three are not known.
  double min_score = -12;         ///< Log odds below which a placement is dropped.
  int max_placements = 50;        ///< Paper section VI.
  std::vector<PosePrior> priors;  ///< Valid; those of other models are ignored.
  int draws_per_prior = 300;      ///< Poses that each prior suggests.
  ScoreLayers layers = default_score_layers();
  std::uint64_t seed = 0;
};

/// The best placements of one model in the scene (paper section V), best first. Deterministic.
/// `trace`, if given, receives what happened on the way.
std::vector<Candidate> detect_object(const SceneFeatures& scene,
                                     const std::shared_ptr<const ObjectModel>& model,
                                     const SingleObjectOptions& options,
                                     ObjectTrace* trace = nullptr);

/// Scores poses of one model with every component of rounds two and three, or of round two alone:
/// then those of round three are not known. Keeps references.
class PlacementEvaluator {
 public:
  PlacementEvaluator(const SceneFeatures& scene, std::shared_ptr<const ObjectModel> model,
                     const ScoreLayers& layers, bool use_round_three = true);

  Candidate evaluate(Refinement refinement) const;

 private:
  const SceneFeatures& scene_;
  std::shared_ptr<const ObjectModel> model_;
  const ScoreLayers& layers_;
  bool use_round_three_;
  FeaturePlaces places_;
};

/// The candidate as it is reported: with covariance, orientation uncertainty and named components.
Placement to_placement(const Candidate& candidate);

}  // namespace bpa
