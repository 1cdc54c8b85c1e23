// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/contest.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/detect/search.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {

Claim claim_of(const Candidate& candidate) {
  return {candidate.score, candidate.place().cast<float>(),
          static_cast<float>(candidate.model->diameter)};
}

Contest contest_of(std::vector<Claim> claims, int most) {
  std::ranges::stable_sort(claims, std::greater(), &Claim::score);
  Contest out{kNoLimit, std::move(claims)};
  if (std::ssize(out.claims) <= most) return out;
  out.threshold = out.claims[most].score;
  std::erase_if(out.claims, [&](const Claim& claim) { return claim.score <= out.threshold; });
  return out;
}

double behind_best(const Claim& claim, const Contest& contest, double limit) {
  const double ahead = std::isfinite(limit) ? claim.score - limit : claim.score;
  for (const Claim& other : contest.claims) {
    if (other.score <= ahead) return 0;
    const float reach = tolerance::kContested * std::min(other.diameter, claim.diameter);
    if ((other.place - claim.place).squaredNorm() < reach * reach) {
      return claim.score - other.score;
    }
  }
  return 0;
}

}  // namespace bpa::detect
