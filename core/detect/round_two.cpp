// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/bpa_alignment.hpp"
#include "core/detect/stages.hpp"
#include "core/model/model_index.hpp"

namespace bpa {
namespace {

float check_score(const Search& search, const Pose& pose) {
  const RoundTwoOptions& options = search.options.round_two;
  return check_pose(search.scene.image, search.model.index->check, to_fast(pose),
                    options.check_points, options.tolerance)
      .score();
}

// Proposes alignments; each is accepted if the check score improves.
Pose aligned(const Search& search, const Pose& start) {
  const RoundTwoOptions& options = search.options.round_two;
  Pose best = start;
  float best_score = check_score(search, start);
  const auto propose = [&](const Pose& pose) {
    const float score = check_score(search, pose);
    if (score > best_score) {
      best = pose;
      best_score = score;
    }
  };
  auto gate = static_cast<float>(options.start_gate_m);
  for (int step = 0; step < options.bpa_steps; ++step) {
    propose(align_to_surface(search.scene, search.model, best, gate,
                             search.seed + static_cast<std::uint64_t>(step), search.options));
    gate *= static_cast<float>(options.gate_decay);
  }
  propose(search.refine(best, options.refinement).camera_from_object);
  return best;
}

}  // namespace

Candidates round_two(const Search& search, Candidates clusters) {
  std::size_t done = 0;
  for (Candidate& candidate : clusters) {
    if (search.late() && done > 0) break;
    candidate.refinement.camera_from_object = aligned(search, candidate.pose());
    candidate.score = search.quick_score(candidate.pose());
    ++done;
  }
  clusters.resize(done);
  return clusters;
}

}  // namespace bpa
