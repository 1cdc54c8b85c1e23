// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/base/stopwatch.hpp"
#include "core/detect/search.hpp"
#include "core/pipeline/detector.hpp"

namespace bpa {

/// What a search reads; keeps references.
struct LibrarySearch {
  const SceneFeatures& scene;
  const DetectorOptions& options;
  const ScoreLayers& layers;
  const DetectRequest& request;
  Deadline deadline;
  double preparation_ms = 0;  ///< Of the whole preparation; the search may be that much slower.
  std::function<void(Candidates)> on_round = {};  ///< Receives the candidates after each round.

  /// The candidates of all models. Searches in rounds: each takes another sample of the scene, and
  /// surface that certain placements explain is searched no more. Models compete in each round.
  /// What is expected of an earlier frame is scored first. With a deadline, rounds are as large as
  /// fits (search_plan.hpp), and there are more of them. `cut`: whether time ran out. `effort`: the
  /// counts of all models.
  Candidates run(const std::vector<std::shared_ptr<const ObjectModel>>& models,
                 std::vector<ObjectTrace>* traces, bool& cut, SearchEffort& effort) const;

 private:
  void score_expected(std::vector<Search>& searches, std::vector<Candidates>& found,
                      std::vector<ObjectTrace>* traces) const;
};

}  // namespace bpa
