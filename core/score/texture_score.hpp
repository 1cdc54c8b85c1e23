// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/cloud/image.hpp"
#include "core/model/object_model.hpp"
#include "core/score/likelihood.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa::score {

/// How well the pattern of a placement's surface is seen in the image, whatever light, exposure and
/// white balance are: each may multiply a colour channel, and light falls off linearly with the
/// surface's normal.
struct TextureAgreement {
  /// Mean log-likelihood ratio of a pixel: the model's pattern against a surface of one colour.
  /// Near 0 where neither has a pattern; negative where the model's pattern is not seen.
  double log_ratio = kNotKnown;
  /// Sum over pixels that are as far apart as colours are blurred.
  double total = kNotKnown;
};

/// Compares pixels of the reduced image that the placement explains, or that have no depth, away
/// from its outline, where blurred colours are mixed; 0 where they are few. Not known where
/// `observed` (log_light() of the image) or model.index->log_light is empty. The best of nine
/// shifts by two pixels counts, since colour and depth are never registered exactly.
TextureAgreement compare_texture(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                                 const ObjectModel& model, const PredictedSurface& predicted);

/// Of the poses that the symmetry of the model's shape makes equal, the one whose pattern is seen
/// best; `camera_from_object` itself where colours or a symmetry are missing or no other pose is
/// clearly better. `predicted` is of that pose.
Pose turn_to_pattern(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                     const ObjectModel& model, const Pose& camera_from_object,
                     const PredictedSurface& predicted);

}  // namespace bpa::score
