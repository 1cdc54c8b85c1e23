// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/placement.hpp"

namespace bpa {

/// One way to explain the frame: a set of placements (paper section VI).
struct Interpretation {
  int rank = 1;                       ///< 1 is the best.
  double score = 0;                   ///< The multi-object-placement score; larger is better.
  double probability = 0;             ///< Among the interpretations returned; they sum to 1.
  std::vector<Placement> placements;  ///< By falling probability. Empty: nothing known is there.
};

struct StageTiming {
  std::string stage;
  double milliseconds = 0;
};

/// What one frame was found to hold.
struct SceneInterpretations {
  std::int64_t stamp_ns = 0;                    ///< The frame's.
  std::string frame_id;                         ///< The frame's.
  std::vector<Interpretation> interpretations;  ///< Ranked; at least one (perhaps of no objects).
  std::vector<StageTiming> timings;             ///< In the order the stages ran.
  double total_milliseconds = 0;
  bool budget_exhausted = false;  ///< The time budget ended the search: this is the best so far.
  int fused_frames = 1;           ///< How many frames the depth that was searched is made of.
};

}  // namespace bpa
