// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/geometry/symmetry.hpp"

// The depth model, and the tolerances of depth and place that all rooms share. Depths are in
// standard deviations, places in diameters. The counts of standard deviations are the whole
// numbers nearest to values that were chosen by hand on simulated piles. So were all numbers
// without a source; each says where it is used.

namespace bpa::tolerance {

// The depth model: standard deviations at a right pose, metres. The sensor's is SensorNoise.
constexpr float kModelSigma = 0.001f;      ///< Of the model alone: detect/refinement.cpp.
constexpr double kPlacedSigma_m = 0.0025;  ///< Of the model and its pose together.

/// So many standard deviations of a placed model, metres.
constexpr double placed_m(double sigmas) { return sigmas * kPlacedSigma_m; }
constexpr float placed(double sigmas) { return static_cast<float>(placed_m(sigmas)); }
constexpr float kPlacedSigma = placed(1);

/// Standard deviation of what the sensor and, independently, a placed model are off by, metres.
inline float depth_sigma(float sensor, float model) {
  return std::sqrt(sensor * sensor + model * model);
}

/// A tolerance on depth in standard deviations of a sensor and a placed model together.
struct Sigmas {
  float count;

  /// Metres, at a depth where the sensor's standard deviation is `noise`.
  float operator()(float noise) const { return count * depth_sigma(noise, kPlacedSigma); }
};

// Depth. A normal error is larger than three standard deviations in 0.3 % of the pixels. Errors of
// sensors have longer tails, so stricter claims need more standard deviations.
constexpr Sigmas kOnSurface{3};  ///< Below: the observed surface is the predicted one.
constexpr Sigmas kBreaks{4};     ///< Above: neighbouring pixels show two surfaces.
constexpr Sigmas kGoesOn{5};     ///< Below: the surface may go on from one pixel to the next.
constexpr Sigmas kApart{7};      ///< Above: one surface occludes the other, or space is free.
constexpr Sigmas kFollowed{10};  ///< Above: the pixel shows another object.
constexpr float kSameDepth = placed(4);     ///< Of two predictions: score/rival_poses.cpp.
constexpr float kOutlineStep = placed(12);  ///< Of one prediction: score/silhouette_score.cpp.
constexpr float kSameFeature = placed(4);   ///< score/feature_score.cpp.
constexpr float kInside = placed(4);        ///< In another model: detect/exclusion.cpp.
constexpr float kInContact = placed(1.6);   ///< Above the lowest point: score/resting_score.cpp.

// Standard deviations of single errors.
constexpr float kRivalSigma = placed(1.2);    ///< Along the view, rivals: score/rival_poses.cpp.
constexpr float kLateralSigma = placed(1.2);  ///< Across the view: score/surface_agreement.cpp.
constexpr float kEdgeSigma = placed(1.6);     ///< Of edges of 66 views: detect/refinement.cpp.
constexpr double kDistanceSigma = 4 * kPlacedSigma_m;    ///< score/segment_, random_walk_score.
constexpr double kVisibilitySigma = 4 * kPlacedSigma_m;  ///< 1 cm (paper V.5, footnote).

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
