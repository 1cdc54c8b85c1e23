// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa {
namespace {

// Null where there is none.
const char* reason_to_reject(const Search& search, const Pose& pose) {
  const CheckOptions& options = search.options.check;
  PoseCheck result = search.check(pose, options.points);
  // Where most of the object is hidden, the few points in sight are too few to judge by.
  if (result.seen < options.few_seen && result.agreeing > 0 &&
      2 * result.free_space <= result.seen) {
    result = search.check(pose, options.hidden_points);
  }
  if (result.free_space > 0 &&
      static_cast<double>(result.free_space) / result.seen > options.max_free_space) {
    return "too much in free space";
  }
  if (result.seen < options.min_seen) return "too few points in sight";
  const bool off = result.score() < static_cast<float>(options.min_check_score);
  return off ? "not on the surface" : nullptr;
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

// The best few of each pose cell, so that an easy object does not crowd out a hard one.
struct PoseCells {
  const Search& search;
  std::map<std::uint64_t, Candidates> cells;

  void add(Candidate candidate) {
    Candidates& cell = cells[pose_cell(search.model.symmetry, to_fast(candidate.pose()))];
    if (std::ssize(cell) < search.options.check.max_kept_per_cell) {
      cell.push_back(std::move(candidate));
      return;
    }
    Candidate& worst = *std::ranges::min_element(cell, {}, &Candidate::score);
    if (candidate.score > worst.score) std::swap(worst, candidate);
    search.reject("better ones beside it", candidate.pose());
  }

  // Ordered by cell.
  Candidates take() {
    Candidates out;
    for (auto& [key, cell] : cells) std::ranges::move(cell, std::back_inserter(out));
    return out;
  }
};

}  // namespace

Candidates check_free_space(const Search& search, Candidates sampled) {
  const CheckOptions& options = search.options.check;
  PoseCells cells{search, {}};
  Candidates suggested;
  for (Candidate& candidate : sampled) {
    if (search.late()) break;
    if (const char* reason = reason_to_reject(search, candidate.pose())) {
      search.reject(reason, candidate.pose());
      continue;
    }
    candidate.score = search.quick_score(candidate.pose(), options.rank_points);
    if (candidate.found_by == Source::prior) {
      suggested.push_back(std::move(candidate));
    } else {
      cells.add(std::move(candidate));
    }
  }
  Candidates kept = cells.take();
  keep_best(search, options.max_suggested, suggested);
  keep_best(search, options.max_kept, kept);
  std::ranges::move(suggested, std::back_inserter(kept));
  sort_by_score(kept);
  return kept;
}

}  // namespace bpa
