// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/life.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/track/history.hpp"

namespace bpa::track {
namespace {

// Chosen by hand. Log odds that an object is there by one search that finds it. Searches of one
// scene err alike, so the last ones are averaged, not added.
constexpr double kLeastFound = 0.2, kMostFound = 4;
constexpr int kSearches = 5;
// Log weights: of another pose that a search suggests for a track; of one search that takes one of
// the poses for right.
constexpr double kDoubt = -2, kMostSaid = 2.5;

// Of a search's covariance, which is wide as a hypothesis may be aligned badly. The normalised
// squared error of tracked poses has 0.10 of chi-square's mean and 0.15 of its 95 % quantile (11
// objects, 4694 frames: sequences 1 and 9 of docs/server.md).
constexpr double kOfSearch = 0.15;

}  // namespace

void Life::judge(double log_odds) {
  ++searches;
  evidence += (log_odds - evidence) / std::min(searches, kSearches);
}

void Life::believe(const Placement& placement, std::int64_t stamp) {
  if (stamp == found_ns) return;
  found_ns = stamp;
  ++found;
  missed = 0;
  judge(std::clamp(score::log_odds_of(placement.presence), kLeastFound, kMostFound));
}

void Life::doubt(double log_odds) {
  ++missed;
  judge(log_odds);
}

void Life::suggest(const Placement& placement, const Pose& now_from_then) {
  for (const PoseAlternative& other : placement.alternatives) {
    add_mode(body, now_from_then * other.frame_from_object, kDoubt);
  }
  const double says = std::clamp(score::log_odds_of(placement.probability), 0.0, kMostSaid);
  favour_mode(body, now_from_then * placement.frame_from_object, kDoubt, says);
}

bool Life::confirm(double min_probability) {
  const bool was = sure;
  const bool seen = body.sight == Sight::seen;
  sure = was ? evidence >= 0
             : seen && evidence >= 0 &&
                   (found > 1 || score::probability_of(evidence) >= min_probability);
  if (seen) state = sure ? TrackState::confirmed : TrackState::tentative;
  if (state == TrackState::occluded && !sure) state = TrackState::tentative;
  return sure && !was;
}

Track report(const Life& life, std::int64_t stamp_ns) {
  const Body& body = life.body;
  Track out{.id = life.id,
            .name = life.name,
            .model = body.model->name,
            .model_number = body.model->number,
            .state = life.state,
            .probability = score::probability_of(life.evidence),
            .frame_from_object = body.motion.pose(),
            .covariance = kOfSearch * body.motion.covariance(),
            .velocity = body.motion.velocity(),
            .angular_velocity = body.motion.angular_velocity(),
            .visible_fraction = body.visible_fraction,
            .age_s = seconds(stamp_ns - life.born_ns),
            .unseen_s = seconds(stamp_ns - life.seen_ns),
            .held = life.held};
  out.orientation = orientation_uncertainty(out.frame_from_object.rotation,
                                            out.covariance.bottomRightCorner<3, 3>());
  double sum = 1;
  for (const Mode& mode : body.modes) sum += std::exp(mode.log_weight);
  out.weight = 1 / sum;
  for (const Mode& mode : body.modes) {
    out.alternatives.push_back(
        {out.frame_from_object * mode.object_from_mode, std::exp(mode.log_weight) / sum});
  }
  std::ranges::stable_sort(out.alternatives, std::greater(), &PoseAlternative::weight);
  return out;
}

}  // namespace bpa::track
