// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/cloud/image.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/score/pose_check.hpp"
#include "core/score/predicted_surface.hpp"

// How well the boundaries that a placement predicts fit the observed edge image (paper V.5, V.8).
// `edges` is the edge image, of the size of `image`.

namespace bpa::score {

/// Edge likelihood: the range edges of the closest of the 66 views, projected into the edge image.
/// The average log-likelihood, weighted by visibility probability, in [-1, 0]. 0: every edge point
/// is on an edge. -1: no edge point is on an edge, or none is visible. An edge point stands for the
/// end of the surface up to 8 mm beyond it; the best edge on the way counts. 0 for an incomplete
/// model, whose rim is no edge.
double edge_likelihood_score(const CheckImage& image, const Image<float>& edges,
                             const ObjectModel& model, const Pose& camera_from_object);

/// Occlusion edges: there must be an edge where the predicted surface changes from visible to
/// occluded. Occluded: more than 2 cm behind the observed one. The average log-likelihood over the
/// pixels on both sides, in [-1, 0]; 0 where nothing is occluded.
double occlusion_edge_score(const CheckImage& image, const Image<float>& edges,
                            const PredictedSurface& predicted);

}  // namespace bpa::score
