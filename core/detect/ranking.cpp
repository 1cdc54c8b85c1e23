// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/ranking.hpp"

#include <algorithm>
#include <functional>
#include <unordered_map>

namespace bpa {
void sort_by_score(Candidates& candidates) {
  std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
}

void sort_by_check_score(Candidates& candidates) {
  std::ranges::stable_sort(candidates, std::greater(), &Candidate::check_score);
}

bool duplicates(const Search& search, const Pose& a, const Pose& b) {
  constexpr double kFar = 0.05;  // metres, whatever the symmetry
  const Eigen::Vector3d& centre = search.model.centre;
  if ((a * centre - b * centre).norm() > kFar) return false;
  const PoseError error = pose_error(a, b, search.model.symmetry);
  const SelectOptions& options = search.options.select;
  return error.position < options.duplicate_m && error.angle < options.duplicate_rad;
}

void suppress_duplicates(const Search& search, Candidates& candidates) {
  sort_by_score(candidates);
  Candidates kept;
  for (Candidate& candidate : candidates) {
    const bool seen = std::ranges::any_of(kept, [&](const Candidate& other) {
      return duplicates(search, candidate.pose(), other.pose());
    });
    if (seen) {
      search.reject("duplicate of a better one", candidate.pose());
    } else {
      kept.push_back(std::move(candidate));
    }
  }
  candidates = std::move(kept);
}

void keep_first(const Search& search, int count, Candidates& candidates) {
  if (std::ssize(candidates) <= count) return;
  const auto end = candidates.begin() + count;
  for (auto c = end; c != candidates.end(); ++c) search.reject("better ones are enough", c->pose());
  candidates.erase(end, candidates.end());
}

std::uint64_t position_cell(const Eigen::Vector3f& position, float per_metre) {
  const Eigen::Vector3i cell = (position * per_metre).array().floor().cast<int>() + 512;
  return static_cast<std::uint64_t>(cell.x() & 1023) << 20 |
         static_cast<std::uint64_t>(cell.y() & 1023) << 10 |
         static_cast<std::uint64_t>(cell.z() & 1023);
}

void keep_best_of_places(const Search& search, int count, double rank_penalty,
                         Candidates& candidates) {
  constexpr float kPlacesPerMetre = 20;
  sort_by_check_score(candidates);
  if (std::ssize(candidates) <= count) return;
  std::unordered_map<std::uint64_t, int> met;
  std::vector<std::pair<float, std::size_t>> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const int rank = met[position_cell(candidates[i].place().cast<float>(), kPlacesPerMetre)]++;
    order.push_back(
        {-candidates[i].check_score + static_cast<float>(rank_penalty) * static_cast<float>(rank),
         i});
  }
  std::ranges::sort(order);
  Candidates ordered;
  for (const auto& [penalised, i] : order) ordered.push_back(std::move(candidates[i]));
  candidates = std::move(ordered);
  keep_first(search, count, candidates);
  sort_by_check_score(candidates);
}

}  // namespace bpa
