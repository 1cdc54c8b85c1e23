// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/detect/refinement.hpp"
#include "core/model/object_model.hpp"
#include "core/result/placement.hpp"
#include "core/score/components.hpp"
#include "core/score/limits.hpp"

namespace bpa::detect {

/// What suggested a pose: an FPFH match, the votes of oriented point pairs, the caller's prior, or
/// a flat region. `count` is how many there are, and stays last.
enum class Source : std::uint8_t { feature, pairs, prior, region, count };

/// One model at one pose, from the first guess to the placement that is returned. Later stages fill
/// the later fields.
struct Candidate {
  const ObjectModel* model = nullptr;  ///< Lives as long as the library.
  /// The pose with the information of the last alignment.
  Refinement refinement = {};
  Source found_by = Source::feature;
  /// Stays whatever its log odds, beside better ones and beyond counts: what the caller's priors or
  /// an earlier frame suggest.
  bool is_protected = false;
  int scene_point = -1;  ///< Of the correspondence: index into SceneFeatures::surface (feature) or
                         ///< ::coarse (pairs), of the region in ::flat; -1: it has none.
  int model_point = -1;  ///< Index into ModelIndex::features or ::coarse; -1: it has none.

  score::ScoreValues values{};       ///< Since refine.
  double prior = 0;                  ///< Log odds that the caller's priors add; 0 without any.
  double score = 0;                  ///< Log odds by the learned layer, with `prior`; since check.
  double probability = 0;            ///< Of that score, without rivals. Since refine.
  score::LowestLogOdds lowest = {};  ///< For measuring limits.
  std::vector<std::uint32_t> explained = {};  ///< Sorted pixels of the reduced image on the model.

  const Pose& pose() const { return refinement.frame_from_object; }
  /// Where the object's centre is, in the frame of pose().
  Eigen::Vector3d place() const { return pose() * model->centre; }
};
using Candidates = std::vector<Candidate>;

/// The candidate as it is reported: with covariance, orientation uncertainty and named components.
Placement to_placement(const Candidate& candidate);

}  // namespace bpa::detect
