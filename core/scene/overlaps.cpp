// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/scene/overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include "core/detect/exclusion.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::scene {
namespace {

double same_pose(const detect::Candidate& a, const detect::Candidate& b) {
  if (a.model != b.model || (a.place() - b.place()).norm() > tolerance::kFarRivals) return 0;
  const PoseError error = pose_error(a.pose(), b.pose(), a.model->symmetry);
  return std::clamp(
      1.5 - std::max(error.position / kPoseTolerance_m, error.angle / kPoseTolerance_rad), 0.0,
      1.0);
}

// How many pixels each two candidates share, row by row; counted through an index from pixels to
// the candidates that explain them.
std::vector<int> common_pixels(const detect::Candidates& candidates,
                               const std::vector<std::uint32_t>& running) {
  std::uint32_t num_pixels = 0;
  for (std::uint32_t i : running) {
    const auto& explained = candidates[i].explained;
    if (!explained.empty()) num_pixels = std::max(num_pixels, explained.back() + 1);
  }
  std::vector<std::uint32_t> begin(num_pixels + 1, 0);
  for (std::uint32_t i : running) {
    for (std::uint32_t pixel : candidates[i].explained) ++begin[pixel + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> next = begin, by_pixel(begin.back());
  for (std::uint32_t r = 0; r < running.size(); ++r) {
    for (std::uint32_t pixel : candidates[running[r]].explained) by_pixel[next[pixel]++] = r;
  }
  const std::size_t count = running.size();
  std::vector<int> common(count * count, 0);
  for (std::uint32_t pixel = 0; pixel < num_pixels; ++pixel) {
    for (std::uint32_t a = begin[pixel]; a < begin[pixel + 1]; ++a) {
      int* row = common.data() + by_pixel[a] * count;
      for (std::uint32_t b = begin[pixel]; b < a; ++b) ++row[by_pixel[b]];
    }
  }
  return common;
}

// Candidates of nearly one pose.
struct PoseGroup {
  std::size_t best = 0;
  double weight = 0;
};

bool one_object(const detect::Candidate& a, const detect::Candidate& b) {
  return a.model == b.model &&
         (a.place() - b.place()).norm() < tolerance::kSamePlace * a.model->diameter;
}

bool nearly_same_pose(const score::Competition& competition, std::size_t a, std::size_t b) {
  return std::ranges::any_of(competition.rivals[a], [b](const score::Competition::Rival& rival) {
    return rival.other == b && rival.same_pose >= 0.5;
  });
}

}  // namespace

Overlaps find_overlaps(const detect::Candidates& candidates, double competing) {
  std::vector<std::uint32_t> running;
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].score >= competing) running.push_back(i);
  }
  const std::vector<int> common = common_pixels(candidates, running);
  Overlaps overlaps(candidates.size());
  for (std::size_t a = 0; a < running.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const detect::Candidate& first = candidates[running[a]];
      const detect::Candidate& second = candidates[running[b]];
      const int shared = common[a * running.size() + b];
      const bool conflicting = detect::exclude(first, second, shared);
      if (shared == 0 && !conflicting) continue;
      overlaps[running[a]].push_back({running[b], shared, conflicting});
      overlaps[running[b]].push_back({running[a], shared, conflicting});
    }
  }
  for (auto& of_one : overlaps) std::ranges::sort(of_one, {}, &Overlap::other);
  return overlaps;
}

score::Competition competition_of(const detect::Candidates& candidates, const Overlaps& overlaps) {
  score::Competition out;
  out.rivals.resize(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (const Overlap& overlap : overlaps[i]) {
      if (!overlap.conflicting) continue;
      out.rivals[i].push_back({overlap.other, same_pose(candidates[i], candidates[overlap.other])});
    }
  }
  return out;
}

score::Competition of_objects(const detect::Candidates& candidates, score::Competition poses) {
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (score::Competition::Rival& rival : poses.rivals[i]) {
      if (one_object(candidates[i], candidates[rival.other])) rival.same_pose = 1;
    }
  }
  return poses;
}

std::vector<PoseAlternative> alternatives_of(const detect::Candidates& candidates,
                                             const score::Competition& competition,
                                             std::size_t chosen, double min_weight) {
  std::vector<int> rivals;
  for (const score::Competition::Rival& rival : competition.rivals[chosen]) {
    if (one_object(candidates[chosen], candidates[rival.other])) {
      rivals.push_back(static_cast<int>(rival.other));
    }
  }
  std::ranges::stable_sort(rivals, std::greater(), [&](int i) { return candidates[i].score; });
  double largest = candidates[chosen].score;
  if (!rivals.empty()) largest = std::max(largest, candidates[rivals.front()].score);
  const auto odds = [&](std::size_t i) { return std::exp(candidates[i].score - largest); };
  std::vector<PoseGroup> groups{{chosen, odds(chosen)}};
  for (const int i : rivals) {
    const auto found = std::ranges::find_if(groups, [&](const PoseGroup& group) {
      return nearly_same_pose(competition, group.best, i);
    });
    if (found == groups.end()) {
      groups.push_back({static_cast<std::size_t>(i), odds(i)});
    } else {
      found->weight += odds(i);
    }
  }
  const auto total = [&groups] {
    double sum = 0;
    for (const PoseGroup& group : groups) sum += group.weight;
    return sum;
  };
  std::erase_if(groups, [&, least = min_weight * total()](const PoseGroup& group) {
    return group.best != chosen && group.weight < least;
  });
  const double sum = total();  // of those that are left
  std::vector<PoseAlternative> out;
  for (const PoseGroup& group : std::span(groups).subspan(1)) {
    out.push_back({candidates[group.best].pose(), group.weight / sum});
  }
  std::ranges::stable_sort(out, std::greater(), &PoseAlternative::weight);
  return out;
}

}  // namespace bpa::scene
