// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/competition.hpp"

#include <algorithm>
#include <cmath>

namespace bpa::score {

std::vector<double> competing_probabilities(std::span<const double> scores,
                                            const Competition& competition) {
  std::vector<double> out(scores.size());
  for (std::size_t i = 0; i < scores.size(); ++i) {
    double largest = std::max(0.0, scores[i]);
    for (const auto& rival : competition.rivals[i]) {
      largest = std::max(largest, scores[rival.other]);
    }
    double right = std::exp(scores[i] - largest);
    double all = right + std::exp(-largest);
    for (const auto& rival : competition.rivals[i]) {
      const double term = std::exp(scores[rival.other] - largest);
      all += term;
      right += rival.same_pose * term;
    }
    out[i] = right / all;
  }
  return out;
}

}  // namespace bpa::score
