// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/cloud/frame.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa {

/// Light and the number that stands for it in an image (IEC 61966-2-1), both in [0, 1].
double linear_of_srgb(double value);
double srgb_of_linear(double value);

// OpenCV's cvtColor picks its rounding by the processor's instruction set; this gives the same bits
// on every machine.

/// Turns sRGB into CIELAB (CIE 1976, white point D65): L in [0, 100], a and b about [-100, 100].
/// Distances of 2.3 are just noticeable. Two tables, within 0.05 of the formulas; make one for many
/// colours.
class CielabConverter {
 public:
  CielabConverter();
  /// `rgb` in [0, 255]; values outside are clamped.
  Eigen::Vector3f operator()(const Eigen::Vector3f& rgb) const;

 private:
  static constexpr int kSteps = 4096;
  std::array<float, 257> linear_;            // of sRGB values 0..255, the last one twice
  std::array<float, kSteps + 2> lightness_;  // the cube root of CIELAB, over [0, 1]
};

/// The cube roots of X, Y and Z of a CIELAB colour, each relative to white (CIE 15). A gain of
/// light multiplies them. Light below 0.001 of white, which is noise, counts as that.
Eigen::Array3f light_roots(const Eigen::Vector3f& lab);

/// Logarithms of light_roots(): of Y, and of X and Z over Y. A gain of a channel adds to them;
/// shading adds to the first alone.
Eigen::Vector3f log_light(const Eigen::Vector3f& lab);

/// The frame's colours at the resolution of its surface map: means of blocks of map.reduction
/// pixels, rgb in [0, 255]. Empty without colour.
Image<Eigen::Vector3f> reduced_color(const Frame& frame, const SurfaceMap& map, int num_threads);

/// CIELAB of every pixel.
Image<Eigen::Vector3f> cielab(const Image<Eigen::Vector3f>& rgb, int num_threads);

}  // namespace bpa
