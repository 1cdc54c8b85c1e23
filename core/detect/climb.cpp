// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/detect/stages.hpp"
#include "core/geometry/tolerance.hpp"

namespace bpa::detect {
namespace {

constexpr double kBeside_rad = 0.17;                       // turn of the six poses beside the start
constexpr double kFirstStep_m = tolerance::placed_m(2.4);  // at the object's rim
constexpr int kStepRounds = 4;                             // of twelve steps each
constexpr RefinementOptions kFromBeside{6, 200, 60, tolerance::placed_m(8),
                                        tolerance::placed_m(3.2)};

// The best pose so far and its score.
struct Best {
  Pose pose;
  double score = 0;

  bool offer(const Pose& other, double other_score) {
    if (other_score <= score) return false;
    pose = other;
    score = other_score;
    return true;
  }
};

Pose turned(const Pose& pose, const Eigen::Vector3d& rotation_vector) {
  Pose out = pose;
  out.rotation = (rotation_from_vector(rotation_vector) * out.rotation).normalized();
  return out;
}

// Along each axis of the camera, there and back.
Eigen::Vector3d direction(int move) {
  return (move % 2 ? -1 : 1) * Eigen::Vector3d::Unit(move / 2 % 3);
}

// Alignments from six poses beside the start: from there, gradients may lead elsewhere.
void align_from_beside(const Search& search, Best& best) {
  const Pose start = best.pose;
  for (int turn = 0; turn < 6 && !search.late(); ++turn) {
    const Pose beside = turned(start, kBeside_rad * direction(turn));
    const Pose refined = search.aligned(beside, kFromBeside);
    best.offer(refined, search.quick_score(refined));
  }
}

// Small steps along and about each axis of the camera; smaller ones when none improves.
void step_uphill(const Search& search, Best& best) {
  double step = kFirstStep_m;
  for (int round = 0; round < kStepRounds && !search.late(); ++round) {
    const double angle = step / (0.5 * search.model.diameter);
    bool improved = false;
    for (int move = 0; move < 12; ++move) {
      Pose pose = best.pose;
      if (move < 6) {
        pose.translation += step * direction(move);
      } else {
        pose = turned(pose, angle * direction(move));
      }
      improved |= best.offer(pose, search.quick_score(pose));
    }
    if (!improved) step *= 0.5;
  }
}

}  // namespace

Candidates climb(const Search& search, Candidates refined) {
  const auto most = std::min<std::size_t>(refined.size(), search.plan.climb.max_climbed);
  parallel_for_spare(static_cast<int>(most), [&](int i) {
    Candidate& candidate = refined[i];
    candidate.lowest.note(score::Limit::climbed, candidate.score);
    if (search.late() || candidate.score < search.plan.limits[score::Limit::climbed]) return;
    Best best{candidate.pose(), search.quick_score(candidate.pose())};
    align_from_beside(search, best);
    step_uphill(search, best);
    Candidate moved = search.scored(candidate, search.measured(best.pose));
    if (moved.score > candidate.score) candidate = std::move(moved);
  });
  return refined;
}

}  // namespace bpa::detect
