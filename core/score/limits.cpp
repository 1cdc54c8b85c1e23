// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/limits.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"

namespace bpa {
namespace {

template <std::size_t N>
void mix(const std::array<double, N>& a, const std::array<double, N>& b, double along,
         std::array<double, N>& out) {
  for (std::size_t i = 0; i < N; ++i) {
    out[i] = a[i] == b[i] ? a[i] : (1 - along) * a[i] + along * b[i];
  }
}

}  // namespace

Result<Limits> LearnedLimits::at(double keep_right, bool colored) const {
  if (keep_right == 1) return Limits::none();
  const auto of = colored ? &Level::with_color : &Level::without_color;
  const auto next =
      std::ranges::find_if(levels, [&](const Level& l) { return l.keep_right >= keep_right; });
  const bool exact = next != levels.end() && next->keep_right == keep_right;
  if (exact) return *next.*of;
  if (next == levels.begin() || next == levels.end()) {
    return invalid_argument("score.keep_right is ", keep_right,
                            "; these score layers have limits for ", levels.front().keep_right,
                            " to ", levels.back().keep_right, "; 1 is without limits");
  }
  const Level& below = *std::prev(next);
  const double along = std::log((1 - below.keep_right) / (1 - keep_right)) /
                       std::log((1 - below.keep_right) / (1 - next->keep_right));
  Limits out;
  mix((below.*of).stages, (*next.*of).stages, along, out.stages);
  mix((below.*of).components, (*next.*of).components, along, out.components);
  return out;
}

}  // namespace bpa
