// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_check.hpp"

#include <cmath>

#include "core/geometry/tolerance.hpp"
#include "core/score/projected_block.hpp"

namespace bpa::score {

double ColorCheck::log_odds() const {
  constexpr int kMinSeen = 6;
  if (seen < kMinSeen) return 0;
  return (agreeing * kAgrees + (seen - agreeing) * kDisagrees) / seen;
}

ColorCheck check_colors(const CheckImage& image, const Image<MatchColor>& colors,
                        const ModelIndex& model, const FastPose& pose) {
  constexpr int kWanted = 20;  // points; chosen by hand on simulated piles
  ColorCheck check;
  if (colors.empty()) return check;
  const auto size = static_cast<int>(model.check_colors.size());
  ProjectedBlock block;
  for (int i = 0; i < size && check.seen < kWanted; ++i) {
    const int lane = i % kCheckBlock;
    if (lane == 0) block.project(image, model.check, pose, i);
    if (block.pixel[lane] < 0) continue;
    const auto at = static_cast<std::size_t>(block.pixel[lane]);
    const CheckPixel& seen = image.pixels[at];
    const float z = block.point[2][lane];
    if (!seen.searched || std::abs(seen.depth - z) > tolerance::kOnSurface(image.noise(z)))
      continue;
    ++check.seen;
    check.agreeing += colors_agree(colors[at], model.check_colors[static_cast<std::size_t>(i)]);
  }
  return check;
}

}  // namespace bpa::score
