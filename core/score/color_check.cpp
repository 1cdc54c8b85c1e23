// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/color_check.hpp"

#include <cmath>

namespace bpa {

double ColorCheck::log_odds() const {
  constexpr int kMinSeen = 6;
  // log(0.95 / 0.44) and log(0.05 / 0.56): see colors_agree().
  constexpr double kAgrees = 0.77, kDisagrees = -2.42;
  if (seen < kMinSeen) return 0;
  return (agreeing * kAgrees + (seen - agreeing) * kDisagrees) / seen;
}

ColorCheck check_colors(const CheckImage& image, const Image<MatchColor>& colors,
                        const ModelIndex& model, const FastPose& pose) {
  // Chosen by hand on simulated piles: points, cosine on the optical axis, metres.
  constexpr int kWanted = 20;
  constexpr float kMinFacing = 0.15f, kOnSurface = 0.012f;
  ColorCheck check;
  if (colors.empty()) return check;
  for (std::size_t i = 0; i < model.check_colors.size() && check.seen < kWanted; ++i) {
    const Eigen::Vector3f p = pose * model.check.points[i];
    if ((pose.rotation * model.check.normals[i]).dot(p) > -kMinFacing * p.z()) continue;
    const int pixel = image.pixel_of(p);
    if (pixel < 0) continue;
    const auto at = static_cast<std::size_t>(pixel);
    const CheckPixel& seen = image.pixels[at];
    if (!seen.searched || std::abs(seen.depth - p.z()) > kOnSurface) continue;
    ++check.seen;
    check.agreeing += colors_agree(colors[at], model.check_colors[i]);
  }
  return check;
}

}  // namespace bpa
