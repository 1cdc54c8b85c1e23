// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/detect/scene_features.hpp"
#include "core/model/object_model.hpp"

namespace bpa {

struct RefinementOptions {
  int iterations = 6;
  int max_points = 200;         ///< Model points used.
  int max_edges = 60;           ///< Model edge points used; 0 = surface only.
  float start_gate_m = 0.030f;  ///< Correspondences further apart do not count, at first
  float end_gate_m = 0.010f;    ///< and in the end.
};

struct Refinement {
  Pose camera_from_object;
  /// Information (inverse covariance) about the camera's axes, of (translation of the object's
  /// origin, rotation), from the correspondences used last.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  int num_correspondences = 0;
};

/// Gradient-based alignment (paper section V): Gauss-Newton on the distances from model points to
/// the observed surface's tangent planes, each model point matched with the pixel it falls on, and
/// from the edges of the model's nearest view to those of the observed surface.
Refinement refine_pose(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                       const RefinementOptions& options);

/// What a round-two alignment makes use of; experiments leave some of it out.
struct AlignmentCues {
  bool orientation = true;  ///< False: positions only, which is what ICP does (paper's ablation).
  bool segments = true;     ///< False: matches on all surface, not on sampled super-pixels.
  bool edges = true;        ///< False: no edge points.
};

/// One round-two alignment step by BPA (paper section V) to sampled segments, the super-pixels: up
/// to `count` model points that fall near the surface of these are matched with it as oriented
/// pairs, and half as many edge points with the frame's edges. The start where fewer than four
/// points match.
Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, int count, std::uint64_t seed, const AlignmentCues& cues = {});

}  // namespace bpa
