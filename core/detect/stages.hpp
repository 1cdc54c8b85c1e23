// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/align/correspondence.hpp"
#include "core/detect/contest.hpp"
#include "core/detect/search.hpp"

// The stages of the search; README.md says what each does and why, CONTRIBUTING.md how to add one.
// A stage takes the candidates of one model from the stage before and returns its own. A stage is
// deterministic, for any number of threads, unless the deadline passes.

namespace bpa::detect {

/// Poses drawn by BPA from feature matches (V.3), voted for by point pairs, and drawn from priors.
/// Ignores its candidates.
Candidates sample(const Search& search, Candidates none);

/// The oriented pair behind a candidate that a feature or a point pair suggested.
align::OrientedPair oriented_pair(const Search& search, const Candidate& candidate);

/// Rejects poses that hang in free space or find no surface (V.3). Keeps the best of each place by
/// the round-two score from a few points.
Candidates check(const Search& search, Candidates sampled);

/// Moves each pose by a few Gauss-Newton steps where the check score improves: a sampled pose is
/// off by as much as the sampling of both surfaces is coarse. Rejects nothing.
Candidates correct(const Search& search, Candidates checked);

/// Groups poses within the pose tolerance, modulo the model's symmetry, and aligns each group again
/// with BPA (V.3). Rejects single feature matches; single voted poses stay.
Candidates cluster(const Search& search, Candidates checked);

/// Aligns each candidate with BPA to sampled super-pixels (V.6) and scores it (V.5). Non-maximum
/// suppression (V.7).
Candidates round_two(const Search& search, Candidates clusters);

/// One alignment by BPA to sampled super-pixels (V.6). Model points within `gate` metres of these
/// give up to RoundTwoOptions::max_pairs oriented pairs. Edge points give half as many positions.
/// Returns `start` where fewer than RoundTwoOptions::min_pairs match.
Pose align_to_surface(const SceneFeatures& scene, const ObjectModel& model, const Pose& start,
                      float gate, std::uint64_t seed, const DetectOptions& options = {});

/// Aligns the best by gradients and removes duplicates (V.7).
Candidates refine(const Search& search, Candidates aligned);

/// Scores each with all components (V.8), in the pose that its pattern shows.
Candidates score(const Search& search, Candidates refined);

/// Hill climbing of the score from and beside the best candidates. Rejects nothing.
Candidates climb(const Search& search, Candidates refined);

/// Adds the best candidates turned by the model's near symmetries.
Candidates turn(const Search& search, Candidates climbed);

/// Adds poses of a thin model at rest on flat regions. Each slides on the plane to where its
/// silhouette agrees best, and is scored with all components. Changes no other candidate.
Candidates lay(const Search& search, Candidates turned);

/// Compares candidates that claim one place on the pixels where they disagree. Rejects nothing.
Candidates compare(const Search& search, Candidates turned);

/// Rejects low scores and duplicates; the best first (V.8).
Candidates select(const Search& search, Candidates compared);

struct Stage {
  std::string_view name;  ///< Of its function, its file and its options.
  Candidates (*run)(const Search&, Candidates);
  std::string_view text;  ///< What it does, for people.
  /// How many candidates of all models together go on, the best by score; null: all.
  int (*most_in_library)(const DetectPlan&) = nullptr;
  /// How far a candidate may be behind the best in its place, of any model; none: however far.
  std::optional<score::Limit> behind = {};
};

/// The stages in their order. Those up to `score` find placements in a sample of the scene, once in
/// each round; the others see what all rounds have found.
std::span<const Stage> detection_stages();
std::span<const Stage> round_stages();
std::span<const Stage> final_stages();
/// Those of a round from `refine` on: what aligns and scores a pose that is known well.
std::span<const Stage> scoring_stages();

/// Runs stages for several models of one scene, each stage for all models before the next. Models
/// compete where a stage has `most_in_library` or `behind`. Protected candidates always go on.
/// `found` holds the candidates of each search, before and after. Deterministic unless the deadline
/// of the first search passes; all models get an equal share of the time. `traces`, if given,
/// receives the stages of each search.
void run_stages(std::span<const Stage> stages, std::span<Search> searches, int num_threads,
                std::vector<Candidates>& found, std::vector<ObjectTrace>* traces = nullptr);

}  // namespace bpa::detect
