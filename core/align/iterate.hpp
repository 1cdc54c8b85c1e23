// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "core/align/align.hpp"

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
