// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/geometry/symmetry.hpp"

// How near is near: the depth model, and the tolerances that observation, scores, stages, scenes
// and tracks share. Depths are in standard deviations of it, places in diameters. A number without
// a source was chosen by hand. Several numbers for one idea stand side by side until a measurement
// unifies them; each says where it is used.

namespace bpa::tolerance {

// The depth model: standard deviations at a right pose, metres. The sensor's is SensorNoise.
constexpr float kModelSigma = 0.001f;      ///< Of the model alone: detect/refinement.cpp.
constexpr double kPlacedSigma_m = 0.0025;  ///< Of the model and its pose together.

/// So many standard deviations of a placed model, metres.
constexpr double placed_m(double sigmas) { return sigmas * kPlacedSigma_m; }
constexpr float placed(double sigmas) { return static_cast<float>(placed_m(sigmas)); }

/// Standard deviation of what the sensor and, independently, a placed model are off by, metres.
inline float depth_sigma(float sensor, float model) {
  return std::sqrt(sensor * sensor + model * model);
}

/// A tolerance that grows with the sensor's noise.
struct WithNoise {
  float metres;         ///< Of a sensor without noise.
  float sensor_sigmas;  ///< Standard deviations of depth, added.

  constexpr float operator()(float noise) const { return metres + sensor_sigmas * noise; }
};

// Standard deviations of single errors.
constexpr float kPlacedSigma = placed(1);     ///< Along the view: score/surface_agreement.cpp.
constexpr float kRivalSigma = placed(1.2);    ///< Along the view, rivals: score/rival_poses.cpp.
constexpr float kLateralSigma = placed(1.2);  ///< Across the view: score/surface_agreement.cpp.
constexpr float kEdgeSigma = placed(1.6);     ///< Of edges of 66 views: detect/refinement.cpp.
constexpr double kDistanceSigma = 4 * kPlacedSigma_m;    ///< score/segment_, random_walk_score.
constexpr double kVisibilitySigma = 4 * kPlacedSigma_m;  ///< 1 cm (paper V.5, footnote).

// On the surface: what is observed and what is predicted are one surface.
constexpr WithNoise kOnSurface{placed(2.4), 2};  ///< Times the slant: score/surface_agreement.cpp.
constexpr WithNoise kOnFace{placed(2.4), 3};  ///< Beside a point: observation/scene_features.cpp.
constexpr float kExplained = placed(4);    ///< score/predicted_surface.hpp, random_walk_score.cpp.
constexpr float kSameDepth = placed(4);    ///< Of two predictions: score/rival_poses.cpp.
constexpr float kOnModel = placed(4);      ///< 1 cm (paper V): score/segment_scores.cpp.
constexpr float kSameFeature = placed(4);  ///< score/feature_score.cpp.
constexpr float kColored = placed(4.8);    ///< score/color_check.cpp; on simulated piles.
constexpr float kFollowed = placed(10);    ///< Where an edge is looked for: detect/matches.cpp.
constexpr float kTouched = placed(12);     ///< Super-pixels: score/segment_scores.cpp.

// The surface goes on from one pixel to another, or breaks off; surface_breaks() is of the map.
constexpr WithNoise kGoesOn{placed(4.8), 2};  ///< detect/matches.cpp, score/surface_agreement.cpp.
constexpr float kOutlineStep = placed(12);    ///< score/silhouette_score.cpp; on simulated piles.

// In front and behind.
constexpr float kHides = placed(8);          ///< hides(), unless its caller says another.
constexpr float kHidesPoint = placed(6);     ///< score/surface_agreement.cpp: points and edges.
constexpr float kFree = placed(8);           ///< Free space: score/surface_agreement.cpp.
constexpr float kInside = placed(4);         ///< In another model: detect/exclusion.cpp.
constexpr WithNoise kBelow{placed(3.2), 2};  ///< A plane: score/resting_score.cpp; on piles.

// On a plane, by hand on simulated piles and tables.
constexpr float kOnBackground = placed(6);  ///< observation/flat_regions.cpp, track/background.cpp.
constexpr float kOnTable = placed(8);       ///< What is seen: score/resting_score.cpp.
constexpr float kRests = placed(6);         ///< The lowest point of a model: the same.
constexpr float kInContact = placed(1.6);   ///< Above the lowest point: the same.

// Beside, across the view.
constexpr float kBesideRim = placed(2.4);   ///< Two alignments' rims: score/rival_poses.cpp.
constexpr float kBesideEdge = placed(3.2);  ///< Observed edges: score/boundary_scores.cpp.
constexpr float kBeyondEdge = placed(4.8);  ///< Observed surface: score/surface_agreement.cpp.

// In one place, in diameters of the smaller model.
constexpr double kSamePlace = 0.4;     ///< Two of one model: detect, track.
constexpr double kOthersPlace = 0.2;   ///< Of two models: detect/exclusion.cpp.
constexpr float kContested = 0.3f;     ///< Of any two: detect/contest.cpp.
constexpr double kCentreMoves = 0.25;  ///< By a symmetry, at most: pipeline/view_pool.cpp.
constexpr double kSamePlaceLeast_m = 12 * kPlacedSigma_m;  ///< At least: track/association.cpp.

// Centres further apart, metres, are of two poses, whatever the symmetry: a fast no.
constexpr double kFarDuplicates = 2 * kPoseTolerance_m;  ///< detect/ranking.cpp.
constexpr double kFarInCluster = 3 * kPoseTolerance_m;   ///< detect/cluster.cpp.
constexpr double kFarRivals = 4 * kPoseTolerance_m;      ///< scene/overlaps.cpp.

// Observations for each independent one: errors of neighbouring pixels go together.
constexpr double kCorrelatedPoints = 12;  ///< detect/to_placement.cpp, pipeline/view_pool.cpp.
constexpr double kCorrelatedColors = 4;   ///< Pixels: score/rival_poses.cpp.

}  // namespace bpa::tolerance

namespace bpa {

/// Whether what is observed hides what is predicted, being over `by` metres in front of it; 0 is no
/// observation and hides nothing.
inline bool hides(float observed_depth, float predicted_depth, float by = tolerance::kHides) {
  return observed_depth > 0 && observed_depth < predicted_depth - by;
}

}  // namespace bpa
