// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "core/align/align.hpp"
#include "core/base/options.hpp"

namespace bpa::align {

/// Correspondences found at a pose. Memory is kept from one iteration to the next.
struct Matches {
  std::vector<OrientedPair> oriented;
  std::vector<PositionPair> positions;
};

/// Fills `matches`, empty when called, with the correspondences that a pose suggests.
using MatchFunction = std::function<void(const Pose& camera_from_object, Matches& matches)>;

enum class Method {
  bpa,  ///< Positions and orientations.
  icp,  ///< The same correspondences, positions only: the paper's ablation.
};

struct IterationOptions {
  Method method = Method::bpa;
  int max_iterations = 20;
  int min_matches = 3;        ///< With fewer a step leaves the pose as it is.
  double position_tol_m = 0;  ///< Ends when a step is smaller than this and
  double angle_tol_rad = 0;   ///< than this. 0: never, as with correspondences drawn at random.

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("max_iterations", max_iterations, FieldRule{0, 10000, "Alignment steps."});
    visit("min_matches", min_matches, FieldRule{1, 1000, "Fewest matches to align with."});
    visit("position_tol_m", position_tol_m, FieldRule{0, 1, "Smallest step that goes on, metres."});
    visit("angle_tol_rad", angle_tol_rad, FieldRule{0, 4, "Smallest step that goes on, radians."});
  }
};

struct IterationResult {
  PoseEstimate estimate;    ///< Of the last step; the start alone if there was none.
  std::vector<Pose> poses;  ///< After each step.
  bool converged = false;   ///< The tolerances were reached.
};

/// Bingham Procrustean Alignment in the place of Horn's method in ICP: match, align, match again
/// (paper, section II.B).
IterationResult iterate(const Pose& start, const MatchFunction& match,
                        const IterationOptions& options = {});

}  // namespace bpa::align
