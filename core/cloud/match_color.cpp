// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/match_color.hpp"

#include <algorithm>
#include <cmath>

#include "core/cloud/cielab.hpp"

namespace bpa {

MatchColor match_color(const Eigen::Vector3f& lab) {
  const Eigen::Array3f roots = light_roots(lab);
  return {std::log(roots[1]), 500 * roots[0] / roots[1], 200 * roots[2] / roots[1], roots[1]};
}

std::vector<MatchColor> color_palette(std::span<const MatchColor> colors, int most) {
  constexpr float kFinest = 0.1f;   // squared standard deviations; chosen by hand, as the factor
  constexpr float kCoarser = 1.5f;  // of radii that are tried
  for (float radius = kFinest;; radius *= kCoarser) {
    std::vector<MatchColor> palette;
    for (const MatchColor& color : colors) {
      const bool near = std::ranges::any_of(
          palette, [&](const MatchColor& other) { return color_distance(color, other) <= radius; });
      if (!near) palette.push_back(color);
      if (std::ssize(palette) > most) break;
    }
    if (std::ssize(palette) <= most) return palette;
  }
}

int nearest_color(std::span<const MatchColor> palette, const MatchColor& color) {
  const auto distance = [&](const MatchColor& other) { return color_distance(color, other); };
  return static_cast<int>(std::ranges::min_element(palette, {}, distance) - palette.begin());
}

}  // namespace bpa
