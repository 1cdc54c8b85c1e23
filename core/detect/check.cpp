// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa::detect {
namespace {

constexpr int kHiddenPoints = 512;  // model points at most, until kFewSeen are in sight
constexpr int kFewSeen = 20, kMinSeen = 6;
constexpr float kMinCheckScore = 0.15f;
// Poses of one cell, the best by check score, that the round-two score ranks; those that go on.
constexpr int kRankedPerCell = 2, kKeptPerCell = 1;
constexpr int kMaxSuggested = 60;  // poses of priors that go on beside the others

struct Verdict {
  const char* reason;  // to reject; null where there is none
  float score;         // of the check
};

Verdict judge(const Search& search, const Pose& pose) {
  const CheckOptions& options = search.plan.check;
  // Where most of the object is hidden, the few points in sight are too few to judge by.
  const score::PoseCheck check = search.check(pose, {options.points, kFewSeen, kHiddenPoints});
  const float score = check.score();
  if (check.free_space > 0 &&
      static_cast<double>(check.free_space) / check.seen > options.max_free_space) {
    return {"too much in free space", score};
  }
  if (check.seen < kMinSeen) return {"too few points in sight", score};
  const bool off = score < kMinCheckScore;
  return {off ? "not on the surface" : nullptr, score};
}

// The cube of 25 mm that a position lies in.
std::uint64_t position_cell(const Eigen::Vector3f& position) {
  constexpr float kCellsPerMetre = 40;
  const Eigen::Vector3i cell = (position * kCellsPerMetre).array().floor().cast<int>() + 512;
  return static_cast<std::uint64_t>(cell.x() & 1023) << 20 |
         static_cast<std::uint64_t>(cell.y() & 1023) << 10 |
         static_cast<std::uint64_t>(cell.z() & 1023);
}

// The cell of 25 mm and about 25 degrees of a pose. A turn about an axis of symmetry does not
// count.
std::uint64_t pose_cell(const SymmetryGroup& symmetry, const FastPose& pose) {
  static constexpr float kCellsPerUnit = 2.5f;
  std::uint64_t key = position_cell(pose.translation);
  const auto add_direction = [&key](const Eigen::Vector3f& direction) {
    const Eigen::Vector3i cell = ((direction.array() + 1) * kCellsPerUnit).floor().cast<int>();
    key = key * 216 + static_cast<std::uint64_t>(cell.x() + 6 * cell.y() + 36 * cell.z());
  };
  if (symmetry.continuous.empty()) {
    add_direction(pose.rotation.col(0));
    add_direction(pose.rotation.col(1));
  } else {
    add_direction(pose.rotation * symmetry.continuous.front().axis.cast<float>());
  }
  return key;
}

// A pose that passed the check: which of the sampled ones, and where it is.
struct Passed {
  std::uint64_t cell;
  std::size_t index;
  float check_score;
};

// Sorts by cell, the best first, and keeps the first few of each.
void keep_best_of_cells(const Search& search, const Candidates& sampled, int most,
                        std::vector<Passed>& passed, auto score) {
  std::ranges::sort(passed, [&](const Passed& a, const Passed& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    if (score(a) != score(b)) return score(a) > score(b);
    return a.index < b.index;
  });
  std::uint64_t cell = 0;
  int count = 0;
  std::erase_if(passed, [&](const Passed& pose) {
    count = pose.cell == cell ? count + 1 : 1;
    cell = pose.cell;
    if (count > most) search.reject("better ones beside it", sampled[pose.index].pose());
    return count > most;
  });
}

}  // namespace

Candidates check(const Search& search, Candidates sampled) {
  const CheckOptions& options = search.plan.check;
  std::vector<Passed> passed;
  std::vector<std::size_t> of_priors;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    if (search.late()) break;
    const Candidate& candidate = sampled[i];
    const Verdict verdict = judge(search, candidate.pose());
    if (verdict.reason) {
      search.reject(verdict.reason, candidate.pose());
    } else if (candidate.is_protected) {
      of_priors.push_back(i);
    } else {
      passed.push_back(
          {pose_cell(search.model.symmetry, to_fast(candidate.pose())), i, verdict.score});
    }
  }
  const auto rank = [&](Candidate& candidate, double least) {
    candidate.score = search.quick_score(candidate.pose(), kCheckRankPoints, least);
  };
  keep_best_of_cells(search, sampled, kRankedPerCell, passed,
                     [](const Passed& pose) { return pose.check_score; });
  for (const Passed& pose : passed) {
    if (search.late()) break;
    rank(sampled[pose.index], search.plan.limits[score::Limit::ranked]);
  }
  keep_best_of_cells(search, sampled, kKeptPerCell, passed,
                     [&](const Passed& pose) { return sampled[pose.index].score; });
  Candidates kept, suggested;
  for (const Passed& pose : passed) kept.push_back(std::move(sampled[pose.index]));
  for (const std::size_t i : of_priors) {
    rank(sampled[i], kNoLimit);
    suggested.push_back(std::move(sampled[i]));
  }
  reject_below(search, score::Limit::ranked, kept);
  keep_best(search, kMaxSuggested, suggested);
  keep_best(search, options.max_kept, kept);
  std::ranges::move(suggested, std::back_inserter(kept));
  sort_by_score(kept);
  return kept;
}

}  // namespace bpa::detect
