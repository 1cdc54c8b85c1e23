// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "core/detect/stages.hpp"

namespace bpa::test {

/// What all stages find of one model in the scene's first sample, best first.
inline detect::Candidates run_all_stages(detect::Search search,
                                         detect::ObjectTrace* trace = nullptr) {
  std::vector<detect::Candidates> found(1);
  std::vector<detect::ObjectTrace> traces;
  detect::run_stages(detect::detection_stages(), {&search, 1}, 1, found, trace ? &traces : nullptr);
  if (trace) *trace = std::move(traces.front());
  return std::move(found.front());
}

}  // namespace bpa::test
