// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "core/detect/ranking.hpp"
#include "core/detect/stages.hpp"

namespace bpa {
namespace {

// Sets the check score; the reason to reject the pose, or null.
const char* reason_to_reject(const Search& search, Candidate& candidate) {
  const CheckOptions& options = search.options.check;
  PoseCheck result = search.check(candidate.pose(), options.points);
  // Where most of the object is hidden, the few points in sight are too few to judge by.
  if (result.seen < options.few_seen && result.agreeing > 0 &&
      2 * result.free_space <= result.seen) {
    result = search.check(candidate.pose(), options.hidden_points);
  }
  candidate.check_score = result.score();
  if (result.free_space > 0 &&
      static_cast<double>(result.free_space) / result.seen > options.max_free_space) {
    return "too much in free space";
  }
  if (result.seen < options.min_seen) return "too few points in sight";
  const bool off = candidate.check_score < static_cast<float>(options.min_check_score);
  return off ? "not on the surface" : nullptr;
}

// The cell of 25 mm and about 25 degrees of a pose. A turn about an axis of symmetry does not
// count.
std::uint64_t pose_cell(const SymmetryGroup& symmetry, const FastPose& pose) {
  constexpr float kCellsPerMetre = 40;
  static constexpr float kCellsPerUnit = 2.5f;
  std::uint64_t key = position_cell(pose.translation, kCellsPerMetre);
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
    Candidate& worst = *std::ranges::min_element(cell, {}, &Candidate::check_score);
    if (candidate.check_score > worst.check_score) std::swap(worst, candidate);
    search.reject("better ones beside it", candidate.pose());
  }

  // Ordered by cell.
  Candidates take() {
    Candidates out;
    for (auto& [key, cell] : cells) std::ranges::move(cell, std::back_inserter(out));
    return out;
  }
};

// A sampled pose is off by as much as the sampling of both surfaces is coarse.
void correct(const Search& search, Candidate& candidate) {
  const CheckOptions& options = search.options.check;
  const Pose corrected = search.refine(candidate.pose(), options.correction).camera_from_object;
  candidate.check_score = search.check(candidate.pose(), options.recheck_points).score();
  const float score = search.check(corrected, options.recheck_points).score();
  if (score <= candidate.check_score) return;
  candidate.refinement.camera_from_object = corrected;
  candidate.check_score = score;
}

void correct_all(const Search& search, Candidates& candidates) {
  for (Candidate& candidate : candidates) {
    if (search.late()) return;
    correct(search, candidate);
  }
}

}  // namespace

Candidates check_free_space(const Search& search, Candidates sampled) {
  const CheckOptions& options = search.options.check;
  PoseCells cells{search, {}};
  Candidates suggested;
  for (Candidate& candidate : sampled) {
    if (search.late()) break;
    if (const char* reason = reason_to_reject(search, candidate)) {
      search.reject(reason, candidate.pose());
    } else if (candidate.found_by == Source::prior) {
      suggested.push_back(std::move(candidate));
    } else {
      cells.add(std::move(candidate));
    }
  }
  Candidates kept = cells.take();
  keep_best_of_places(search, options.max_suggested, options.rank_penalty, suggested);
  keep_best_of_places(search, 2 * options.max_kept, options.rank_penalty, kept);
  correct_all(search, kept);
  keep_best_of_places(search, options.max_kept, options.rank_penalty, kept);
  correct_all(search, suggested);
  std::ranges::move(suggested, std::back_inserter(kept));
  sort_by_check_score(kept);
  return kept;
}

}  // namespace bpa
