// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/result/interpretation.hpp"

namespace bpa {

std::vector<ExpectedPlacement> expected_after(const SceneInterpretations& result) {
  std::vector<ExpectedPlacement> expected;
  if (result.interpretations.empty()) return expected;
  for (const Placement& placement : result.interpretations.front().placements) {
    expected.push_back({placement.model, placement.frame_from_object});
  }
  return expected;
}

}  // namespace bpa
