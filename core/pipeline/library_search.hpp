// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "core/base/stopwatch.hpp"
#include "core/pipeline/model_searches.hpp"

namespace bpa {

struct SearchOutcome {
  detect::Candidates candidates;    ///< Of all models.
  bool cut = false;                 ///< Time ran out.
  SearchEffort effort;              ///< The counts of all models.
  Costs measured = {};              ///< What it took.
  std::vector<double> missed = {};  ///< Objects in sight that are expected undiscovered, by model.
};

/// The search over a library in rounds: each takes another sample of the scene, and surface that
/// certain placements explain is searched no more. Models compete in each round. What is expected
/// of an earlier frame is scored first. With a deadline, rounds are as large as fits
/// (search_plan.hpp), and there are more of them. Keeps references.
struct LibrarySearch {
  const SearchInputs& inputs;
  Deadline deadline;
  Costs costs = {};
  double preparation_ms = 0;  ///< Of the whole preparation of this frame.
  std::function<void(detect::Candidates)> on_round =
      {};  ///< Receives the candidates after each round.

  /// `searches` is where the models are searched.
  SearchOutcome run(ModelSearches& searches) const;
};

}  // namespace bpa
