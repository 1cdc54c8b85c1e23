// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "core/align/correspondence.hpp"
#include "core/detect/search.hpp"

// The stages of the search for one object; README.md says what each does, why, and how to add one.
// Each takes the candidates of the stage before and returns its own. A stage is deterministic, for
// any number of threads, unless the deadline passes.

namespace bpa {

/// Poses drawn by BPA from feature matches (V.3), voted for by point pairs, and drawn from priors.
/// Ignores its candidates.
Candidates sample(const Search& search, Candidates none);

/// The oriented pair behind a candidate that a feature or a point pair suggested.
align::OrientedPair oriented_pair(const Search& search, const Candidate& candidate);

/// Rejects poses that hang in free space or find no surface (V.3); keeps the best of each place.
Candidates check_free_space(const Search& search, Candidates sampled);

/// Groups poses within the pose tolerance, modulo the model's symmetry, and aligns each group again
/// with BPA (V.3). Rejects single feature matches; single voted poses stay.
Candidates cluster(const Search& search, Candidates checked);

/// Aligns each candidate with BPA to sampled super-pixels (V.6) and scores it (V.5). Rejects
/// nothing unless the deadline passes.
Candidates round_two(const Search& search, Candidates clusters);

/// One alignment by BPA to sampled super-pixels (V.6). Model points within `gate` metres of these
/// give up to RoundTwoOptions::max_pairs oriented pairs. Edge points give half as many positions.
/// Returns `start` where fewer than RoundTwoOptions::min_pairs match.
Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, std::uint64_t seed, const DetectOptions& options = {});

/// Non-maximum suppression (V.7); aligns the best by gradients (V.7) and scores them with all
/// components (V.8).
Candidates refine(const Search& search, Candidates aligned);

/// Hill climbing of the score from and beside the best candidates. Rejects nothing.
Candidates climb(const Search& search, Candidates refined);

/// Adds the best candidates turned by the model's near symmetries.
Candidates try_turned(const Search& search, Candidates climbed);

/// Adds poses of a thin model at rest on flat regions. Each slides on the plane to where its
/// silhouette agrees best, and is scored with all components. Changes no other candidate.
Candidates lay_flat(const Search& search, Candidates turned);

/// Compares candidates that claim one place on the pixels where they disagree. Rejects nothing.
Candidates compare_rivals(const Search& search, Candidates turned);

/// Rejects low scores and duplicates; the best first (V.8).
Candidates select(const Search& search, Candidates compared);

struct Stage {
  std::string_view name;
  Candidates (*run)(const Search&, Candidates);
  double time_share;       ///< Of the time left at its start, where there is a deadline.
  std::string_view title;  ///< For people.
  std::string_view text;
};

/// The stages in their order.
std::span<const Stage> detection_stages();

/// Runs the stages: the best placements of one model in the scene (paper section V), best first.
/// Deterministic unless the search's deadline passes: then the best so far. `trace`, if given,
/// receives each stage.
Candidates detect_object(Search search, ObjectTrace* trace = nullptr);

}  // namespace bpa
