// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/result_check.hpp"

#include <algorithm>

#include "core/doctor/frame_check.hpp"

namespace bpa::doctor {

bool says_little(const SceneInterpretations& result) {
  constexpr double kSure = 0.5;
  return result.interpretations.empty() ||
         std::ranges::none_of(result.interpretations.front().placements,
                              [](const Placement& p) { return p.presence >= kSure; });
}

std::string lines_of(Findings findings) {
  std::ranges::stable_sort(findings, std::ranges::greater{}, &Finding::severity);
  std::string lines;
  for (const Finding& finding : findings) {
    lines +=
        (lines.empty() ? "" : "\n") + finding.what + ": " + finding.why + ". " + finding.remedy;
  }
  return lines;
}

std::string advice_on(const Frame& frame, const SceneInterpretations& result, double max_range_m,
                      int num_threads) {
  return says_little(result) ? lines_of(check_frame(frame, max_range_m, num_threads)) : "";
}

}  // namespace bpa::doctor
