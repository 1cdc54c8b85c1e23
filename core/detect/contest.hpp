// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/detect/candidate.hpp"

// Candidates of all models compete after a stage. README.md says why, and what it saves.

namespace bpa::detect {

/// What one candidate puts against others.
struct Claim {
  double score = 0;                                 ///< Log odds.
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< Candidate::place(), metres.
  float diameter = 0;                               ///< Of its model, metres.
};

Claim claim_of(const Candidate& candidate);

/// What a candidate has to pass.
struct Contest {
  double threshold;           ///< Its score must exceed this; minus infinity: any does.
  std::vector<Claim> claims;  ///< Of all candidates that do, best first.
};

/// Of the claims of all models, at most `most` exceed the threshold.
Contest contest_of(std::vector<Claim> claims, int most);

/// Log odds of a claim less those of the best one in its place, of any model; 0 where they are
/// `limit` or more, unless that is minus infinity. Two claims are in one place if their distance is
/// below 0.3 of the smaller diameter.
double behind_best(const Claim& claim, const Contest& contest, double limit);

}  // namespace bpa::detect
