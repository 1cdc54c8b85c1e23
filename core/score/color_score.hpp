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

/// How the colours that a placement predicts agree with the observed ones. kNotKnown where nothing
/// can be compared.
struct ColorAgreement {
  /// Average truncated log-likelihood of the distance in CIELAB, standard deviation 12, in [-1, 0].
  double likelihood = kNotKnown;
  /// Colour shift common to the whole placement, CIELAB units at L = 54, at least 0: another white
  /// balance, or another object.
  double tint = kNotKnown;
  /// Logarithm of the cube root of light, frame to model, common to the whole placement: another
  /// exposure, or another object. White that is seen black: -1.3.
  double exposure = kNotKnown;
};

/// Compares colours (means of 3x3 pixels) where the placement explains the depth (within 1 cm).
/// Light, exposure and white balance of model and frame differ. So the model's cone responses are
/// scaled by one gain a channel (von Kries), the median over the placement. They are also scaled to
/// the light at each pixel. Of lightness only its variation over the placement counts for the
/// likelihood, with weight one half. `observed`: the frame's CIELAB at the image's size. `surface`:
/// the model's (ModelIndex::cielab). Either may be empty.
ColorAgreement compare_colors(const CheckImage& image, const Image<Eigen::Vector3f>& observed,
                              std::span<const Eigen::Vector3f> surface,
                              const PredictedSurface& predicted);

}  // namespace bpa::score
