// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/cloud/image.hpp"
#include "core/model/object_model.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa {

/// How far the predicted colours agree with the observed ones where the placement explains the
/// depth (within 1 cm): the average truncated log-likelihood of their distance in CIELAB, standard
/// deviation 12, in [-1, 0]. The light on the object is unknown, so the model's colours are scaled
/// to the light observed at each place. Of lightness only its variation over the placement counts,
/// with weight one half. Both sides are averaged over 3x3 pixels.
/// kNotKnown when nothing can be compared. `observed` is the frame's CIELAB at the
/// image's size, `surface` the model's (ModelIndex::cielab); either may be empty.
double color_score(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                   std::span<const Eigen::Vector3f> surface, const PredictedSurface& predicted);

}  // namespace bpa
