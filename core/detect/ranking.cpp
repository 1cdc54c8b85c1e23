// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/parallel.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
void sort_by_score(Candidates& candidates) {
  std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
}

bool duplicates(const Search& search, const Pose& a, const Pose& b) {
  const Eigen::Vector3d& centre = search.model.centre;
  if ((a * centre - b * centre).norm() > tolerance::kFarDuplicates) return false;
  const PoseError error = pose_error(a, b, search.model.symmetry);
  constexpr double kDuplicate_m = tolerance::placed_m(3.2), kDuplicate_rad = 0.05;
  return error.position < kDuplicate_m && error.angle < kDuplicate_rad;
}

bool rejected_before(const Search& search, Candidate& candidate) {
  if (!search.before) return false;
  const double limit = search.plan.limits[score::Limit::repeated];
  return std::ranges::any_of(*search.before, [&](const Candidate& other) {
    if (std::isfinite(limit) && other.score >= limit) return false;
    if (!duplicates(search, candidate.pose(), other.pose())) return false;
    candidate.lowest.note(score::Limit::repeated, other.score);
    return other.score < limit;
  });
}

void suppress_duplicates(const Search& search, Candidates& candidates) {
  sort_by_score(candidates);
  Candidates kept;
  for (Candidate& candidate : candidates) {
    const bool seen = std::ranges::any_of(kept, [&](const Candidate& other) {
      return duplicates(search, candidate.pose(), other.pose());
    });
    if (rejected_before(search, candidate)) {
      search.reject("scored low in an earlier round", candidate.pose());
    } else if (seen) {
      search.reject("duplicate of a better one", candidate.pose());
    } else {
      kept.push_back(std::move(candidate));
    }
  }
  candidates = std::move(kept);
}

void reject_below(const Search& search, score::Limit limit, Candidates& candidates) {
  std::erase_if(candidates, [&](Candidate& candidate) {
    candidate.lowest.note(limit, candidate.score);
    const bool low = candidate.score < search.plan.limits[limit] && !candidate.is_protected;
    if (low) search.reject("score too low", candidate.pose());
    return low;
  });
}

void keep_best(const Search& search, int count, Candidates& candidates) {
  sort_by_score(candidates);
  keep_first(search, count, candidates);
}

void keep_first(const Search& search, int count, Candidates& candidates) {
  if (std::ssize(candidates) <= count) return;
  const auto end = candidates.begin() + count;
  for (auto c = end; c != candidates.end(); ++c) search.reject("better ones are enough", c->pose());
  candidates.erase(end, candidates.end());
}

void change_each(const Search& search, Candidates& candidates,
                 const std::function<void(Candidate&)>& change) {
  std::vector<std::uint8_t> reached(candidates.size(), 0);
  parallel_for_spare(static_cast<int>(candidates.size()), [&](int i) {
    if (search.late()) return;
    change(candidates[i]);
    reached[i] = 1;
  });
  Candidates kept;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (reached[i]) kept.push_back(std::move(candidates[i]));
  }
  candidates = std::move(kept);
}

}  // namespace bpa::detect
