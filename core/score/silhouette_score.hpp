// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/cloud/image.hpp"
#include "core/score/likelihood.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa::score {

/// How well the outline of a placement is seen in colour.
struct SilhouetteAgreement {
  /// Mean over the outline of the strongest colour gradient across it, within 1.5 pixels of the
  /// reduced image; in [0, 1].
  double on = kNotKnown;
  /// The same less the mean gradient in that direction on both sides of the outline.
  double contrast = kNotKnown;
};

/// Compares the outline, where it is not hidden, with color_gradients() of the frame. Not known
/// without gradients or where little of the outline is in sight.
SilhouetteAgreement compare_silhouette(const CheckImage& image,
                                       const Image<Eigen::Vector2f>& gradients,
                                       const PredictedSurface& predicted);

}  // namespace bpa::score
