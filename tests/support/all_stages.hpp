// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "core/detect/stages.hpp"

namespace bpa::test {

/// What all stages find of one model in the scene's first sample, best first.
inline Candidates run_all_stages(Search search, ObjectTrace* trace = nullptr) {
  std::vector<Candidates> found(1);
  std::vector<ObjectTrace> traces;
  run_stages(detection_stages(), {&search, 1}, 1, found, trace ? &traces : nullptr);
  if (trace) *trace = std::move(traces.front());
  return std::move(found.front());
}

}  // namespace bpa::test
