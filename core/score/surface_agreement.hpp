// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/check_image.hpp"

namespace bpa::score {

/// How the surface and the edges that a placement predicts agree with the depth image (paper V.5,
/// round two). Log-likelihoods are truncated averages in [-1, 0]; 0 is exact agreement.
struct SurfaceAgreement {
  double range = -1;            ///< Range differences, weighted by visibility probability.
  double normal = -1;           ///< Normal differences, weighted by visibility probability.
  double visibility = 0;        ///< Share of the facing model points that is not hidden, [0, 1].
  double edge = -1;             ///< Model range edges against the observed surface beyond them.
  double edge_visibility = 0;   ///< Share of the model's edge points that is not hidden.
  double edge_support = 0;      ///< Share of the model's edge points where the surface does end.
  double shape = 0;             ///< Spread of the normals of the agreeing points: the second
                                ///< eigenvalue of their mean square, 0 for one flat face.
  double free_space = 0;        ///< Share of the visible points more than 2 cm in front.
  double agreeing = 0;          ///< Share of the visible points on the observed surface.
  double explained_pixels = 0;  ///< Observed pixels (of the reduced image) on the model surface.
  double expected_pixels = 0;   ///< Pixels the model would cover were nothing in front of it.
  double explained_area = 0;    ///< Surface on which the model explains what is seen, m².
  double relative_area = 0;     ///< The same, in squares of the model's diameter.
  double unknown = 0;           ///< Share of the facing model points where no depth is known.
  double background = 0;        ///< Share of the agreeing points on labelled background.

  /// Explained pixels, at most as many as the explained surface covers at one metre and 320 x 240:
  /// evidence grows with the surface, not with how near the camera is.
  double support() const {
    constexpr double kPixelsPerArea = 7e4;  // per m²
    return std::min(explained_pixels, kPixelsPerArea * explained_area);
  }
  double evidence() const { return std::log(std::max(1.0, support())); }
};

/// Compares `model` at `pose` with the image at about `max_points` of the surface points that its
/// nearest view shows (0: all of them). `explained`, if given, receives the sorted indices of the
/// observed pixels that lie on the model.
SurfaceAgreement measure_surface(const CheckImage& image, const ObjectModel& model,
                                 const Pose& pose, int max_points = 0,
                                 std::vector<std::uint32_t>* explained = nullptr);

/// The explained pixels alone, of all points.
std::vector<std::uint32_t> explained_pixels(const CheckImage& image, const ObjectModel& model,
                                            const Pose& pose);

/// Model points that face the camera, and the pixels of those that are hidden by something over
/// 1.5 cm in front of them.
struct HiddenPoints {
  int facing = 0;
  std::vector<std::uint32_t> pixels;  ///< One for each hidden point.
};

/// Looks at about `max_points` of the surface points that the nearest view shows.
HiddenPoints hidden_points(const CheckImage& image, const ObjectModel& model, const Pose& pose,
                           int max_points);

}  // namespace bpa::score
