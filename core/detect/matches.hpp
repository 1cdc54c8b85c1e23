// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/model/view_sphere.hpp"
#include "core/observation/scene_features.hpp"
#include "core/score/pose_check.hpp"

// Points and edges of a model at a pose, matched with what is observed there.

namespace bpa::detect {

/// A model point and the observed surface at the pixel that it falls on. Camera frame, metres.
struct SurfaceMatch {
  Eigen::Vector3f model_point, model_normal;
  Eigen::Vector3f scene_point, scene_normal;
  std::size_t pixel = 0;
};

// What alignment matches; chosen by hand. With the facing limit of pose checks, three seeds of the
// search find 822/1137 objects of YCB-Video and of seeds 100 and 777, and with this one 833/1137.
constexpr float kMatchFacing = 0.1f;  ///< Least `min_facing`, see ProjectedBlock::project().
constexpr float kMatchCosine = 0.6f;  ///< Least cosine between the normals of model and surface.

/// Matches the i-th of `points` at a pose. False where it faces away, leaves the image or falls on
/// background. False where the surface is `gate` metres away or turned by more than 53 degrees.
bool match_surface(const SceneFeatures& scene, const CheckPoints& points, std::size_t i,
                   const FastPose& pose, float gate, SurfaceMatch& match);

/// A point of a model's silhouette at some pose. Camera frame.
struct EdgePoint {
  Eigen::Vector3f point;    ///< Metres.
  Eigen::Vector3f outward;  ///< Unit length: across the edge, away from the model.
};

/// An edge point of a view, at `pose`.
EdgePoint edge_point(const ViewEdge& edge, const FastPose& pose);

/// How far outward of a model edge point the observed surface ends, metres, in [-reach, reach].
/// None where it does not end within reach or a nearer surface hides the end. Follows the surface
/// from inside the model outward, pixel by pixel. It ends where depth jumps back, is unknown or
/// belongs to the labelled background (V.6: edge points align to edge points).
std::optional<float> match_edge(const CheckImage& image, const EdgePoint& edge, float reach);

}  // namespace bpa::detect
