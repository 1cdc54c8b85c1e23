// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/alternatives.hpp"

#include <algorithm>
#include <cmath>

namespace bpa {
namespace {

// Candidates of nearly one pose; the first is the best of them.
struct Group {
  std::vector<std::size_t> members;
  double weight = 0;
};

bool same_pose(const Competition& competition, std::size_t a, std::size_t b) {
  const auto& rivals = competition.rivals[a];
  return std::any_of(rivals.begin(), rivals.end(), [b](const Competition::Rival& rival) {
    return rival.other == b && rival.same_pose >= 0.5;
  });
}

}  // namespace

std::vector<PoseAlternative> alternatives_of(const std::vector<Candidate>& candidates,
                                             const Competition& competition, std::size_t chosen,
                                             double min_weight) {
  std::vector<std::size_t> rivals;
  for (const Competition::Rival& rival : competition.rivals[chosen]) {
    if (candidates[rival.other].model == candidates[chosen].model) rivals.push_back(rival.other);
  }
  std::stable_sort(rivals.begin(), rivals.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].score > candidates[b].score;
  });
  double largest = candidates[chosen].score;
  if (!rivals.empty()) largest = std::max(largest, candidates[rivals.front()].score);
  const auto odds = [&](std::size_t i) { return std::exp(candidates[i].score - largest); };
  std::vector<Group> groups{{{chosen}, odds(chosen)}};
  for (std::size_t i : rivals) {
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return same_pose(competition, group.members.front(), i);
    });
    if (found == groups.end()) {
      groups.push_back({{i}, odds(i)});
    } else {
      found->members.push_back(i);
      found->weight += odds(i);
    }
  }
  double sum = 0;
  for (const Group& group : groups) sum += group.weight;
  std::erase_if(groups, [&](const Group& group) {
    return group.members.front() != chosen && group.weight < min_weight * sum;
  });
  sum = 0;
  for (const Group& group : groups) sum += group.weight;
  std::vector<PoseAlternative> out;
  for (std::size_t g = 1; g < groups.size(); ++g) {
    out.push_back({candidates[groups[g].members.front()].pose(), groups[g].weight / sum});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return out;
}

}  // namespace bpa
