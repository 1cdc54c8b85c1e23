// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/point_pairs.hpp"

namespace bpa {

/// Pairs of a scene's points about some reference points; made once, looked up in every model.
struct ScenePairs {
  struct Partner {
    float distance = 0;           ///< To the reference point, metres.
    std::uint16_t angle_key = 0;  ///< pair_angle_key of the pair.
    std::uint8_t turn = 0;        ///< turn_of the line to the partner, about the reference normal.
  };
  std::vector<int> references;       ///< Indices of the reference points.
  std::vector<std::uint32_t> first;  ///< first[r]..first[r + 1] are the partners of the r-th,
  std::vector<Partner> partners;     ///< by rising distance.
};

/// Half of the pairs within `reach` metres that fix a pose, about the points `references`: those
/// whose indices are both even or both odd.
ScenePairs scene_pairs(const PointCloud& cloud, std::vector<int> references, float reach,
                       int num_threads);

/// A reference point laid on a model point, turned about its normal: a pose that many pairs vote
/// for.
struct VotedPose {
  int reference = 0;    ///< Index of the scene point.
  int model_point = 0;  ///< Index of the model point that `PointPairTable` was made of.
  float turn = 0;       ///< From the model point's basis to the scene point's, radians.
  int votes = 0;
};

/// Votes of each reference point's pairs for the model point it may be and the turn about its
/// normal (Drost et al., section 3.4): the `peaks` best model points of each reference point, best
/// first. `num_model_points` is the size of the cloud that `table` was made of.
std::vector<VotedPose> vote_poses(const ScenePairs& pairs, const PointPairTable& table,
                                  int num_model_points, int peaks);

}  // namespace bpa
