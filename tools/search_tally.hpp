// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/eval/evaluation.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/pipeline/detector.hpp"

// Sums over searched frames: what was right, and how long stages took.

namespace bpa::cli {

/// Whether the interpretation holds a right placement (eval::is_right) of the instance.
bool holds(const Interpretation& interpretation, const io::BopInstance& instance,
           const ObjectModel& model);

/// Right placements of several frames.
struct RightPlacements {
  eval::Ratio reported;         ///< Placements of best interpretations that are right.
  eval::Ratio found;            ///< Instances that a best interpretation holds.
  eval::Ratio found_in_twenty;  ///< Instances that one of the returned interpretations holds.

  /// Adds a frame. Instances count if at least `min_visible` of them is visible and the library has
  /// their model. A placement may be right about any instance.
  void add(const std::vector<io::BopInstance>& truth, const SceneInterpretations& result,
           const ModelLibrary& library, double min_visible);
};

/// Times of stages, summed over frames. Stages of one model's search, "objects: NAME", are summed
/// over models too, on one core each.
class StageTimes {
 public:
  void add(const SceneInterpretations& result, const FrameTrace& trace);
  /// Means of the frames, in the order of the stages; "total" is last.
  std::vector<StageTiming> means() const;

 private:
  void add(const std::string& stage, double milliseconds);

  std::vector<StageTiming> sums_;
  int frames_ = 0;
};

}  // namespace bpa::cli
