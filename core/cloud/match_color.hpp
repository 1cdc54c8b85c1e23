// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace bpa {

/// A colour as hypotheses compare it. Hue is compared at the lightness of both colours, since dark
/// colours hardly differ in hue.
struct MatchColor {
  float lightness = 0;  ///< Logarithm of `root`.
  float x = 0, z = 0;   ///< 500 X / Y and 200 Z / Y of light_roots().
  float root = 0;       ///< Y of light_roots().
};

/// Of a CIELAB colour.
MatchColor match_color(const Eigen::Vector3f& lab);

// Standard deviations and limit: 95 % of the visible points of 8 real and 15 simulated frames
// (5080/5333, 17420/18327) agree with the model's point there, 44 % of random model points do.
constexpr float kHueSigma = 20;            ///< CIELAB.
constexpr float kLightnessSigma = 0.4f;    ///< Light differs by a factor of 3.3: shading, exposure.
constexpr float kMaxColorDistance = 5.4f;  ///< Squared, in standard deviations.

/// How far two colours are apart in any light, in squared standard deviations.
inline float color_distance(const MatchColor& first, const MatchColor& second) {
  constexpr float kHueWeight = 1 / (kHueSigma * kHueSigma);
  constexpr float kLightnessWeight = 1 / (kLightnessSigma * kLightnessSigma);
  const float x = first.x - second.x, z = first.z - second.z;
  const float lightness = first.lightness - second.lightness;
  return (x * x + z * z) * first.root * second.root * kHueWeight +
         lightness * lightness * kLightnessWeight;
}

/// Whether both may be one surface in different light.
inline bool colors_agree(const MatchColor& first, const MatchColor& second) {
  return color_distance(first, second) <= kMaxColorDistance;
}

/// At most `most` (1 or more) of these colours, so that each is near one of them.
std::vector<MatchColor> color_palette(std::span<const MatchColor> colors, int most);

/// The index of the nearest colour of a palette, which must not be empty.
int nearest_color(std::span<const MatchColor> palette, const MatchColor& color);

}  // namespace bpa
