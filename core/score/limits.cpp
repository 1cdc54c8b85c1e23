// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/limits.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/concat.hpp"

namespace bpa::score {
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

namespace {

constexpr std::size_t kFewest = 50;  // placements; the tail has 10 at least
constexpr double kLevels[] = {0.9, 0.9999};

// The log odds below which `share` of the placements lie; `otherwise` where they are too few.
double lowest_share(std::vector<double> log_odds, double share, double otherwise) {
  std::erase_if(log_odds, [](double one) { return !std::isfinite(one); });
  if (log_odds.size() < kFewest) return otherwise;
  const std::size_t tail = std::max<std::size_t>(10, log_odds.size() / 10);
  std::ranges::nth_element(log_odds, log_odds.begin() + static_cast<std::ptrdiff_t>(tail));
  const double threshold = log_odds[tail];
  double excess = 0;
  for (std::size_t i = 0; i < tail; ++i) excess += threshold - log_odds[i];
  const double tail_share = static_cast<double>(tail) / static_cast<double>(log_odds.size());
  return threshold + excess / static_cast<double>(tail) * std::log(share / tail_share);
}

// `of` gives a placement's log odds, by limit.
template <std::size_t N>
void measure(const std::vector<RightPlacement>& right, const auto& of, double keep_right,
             const std::array<double, N>& start, std::array<double, N>& out) {
  for (std::size_t i = 0; i < N; ++i) {
    std::vector<double> log_odds;
    if (std::isfinite(start[i])) {
      for (const RightPlacement& one : right) log_odds.push_back(double{of(one)[i]});
    }
    out[i] = lowest_share(std::move(log_odds), 1 - keep_right, start[i]);
  }
}

}  // namespace

LearnedLimits measure_limits(const std::vector<RightPlacement>& with_color,
                             const std::vector<RightPlacement>& without_color,
                             const LearnedLimits& start) {
  LearnedLimits out;
  for (const double keep_right : kLevels) {
    LearnedLimits::Level& level =
        out.levels.emplace_back(LearnedLimits::Level{keep_right, Limits{}, Limits{}});
    for (const auto& [right, of] :
         {std::pair(&with_color, &LearnedLimits::Level::with_color),
          std::pair(&without_color, &LearnedLimits::Level::without_color)}) {
      const Limits& before = start.levels.back().*of;
      Limits& limits = level.*of;
      const auto stages = [](const RightPlacement& one) { return one.lowest.stages; };
      const auto components = [](const RightPlacement& one) { return one.components; };
      measure(*right, stages, keep_right, before.stages, limits.stages);
      measure(*right, components, keep_right, before.components, limits.components);
    }
  }
  return out;
}

}  // namespace bpa::score
