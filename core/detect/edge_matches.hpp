// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/model/view_sphere.hpp"
#include "core/score/pose_check.hpp"

namespace bpa {

/// A point of a model's silhouette at some pose. Camera frame.
struct EdgePoint {
  Eigen::Vector3f point;    ///< Metres.
  Eigen::Vector3f outward;  ///< Unit length: across the edge, away from the model.
};

/// The k-th edge point of a view of `model` at `pose`.
EdgePoint edge_point(const ObjectModel& model, const ModelView& view, const FastPose& pose,
                     std::size_t k);

/// How far outward of a model edge point the observed surface ends, metres, in [-reach, reach];
/// none where it does not end within reach or something in front hides the end. The surface is
/// followed from inside the model outward, pixel by pixel, until depth jumps back, is unknown or
/// belongs to the labelled background (V.6: edge points align to edge points).
std::optional<float> match_edge(const CheckImage& image, const EdgePoint& edge, float reach);

}  // namespace bpa
