// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/pipeline/search_plan.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

Candidates joined(const std::vector<Candidates>& found) {
  Candidates all;
  for (const Candidates& of_model : found) all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What the placements found so far explain.
struct Explained {
  std::vector<float> probability;            // of each pixel's most probable placement
  std::vector<std::uint8_t> certain;         // flags of pixels that are searched no more
  std::vector<std::uint32_t> newly_certain;  // pixels, since they were last taken

  explicit Explained(std::size_t pixels) : probability(pixels, 0.0f), certain(pixels, 0) {}

  // Adds placements that compete. Returns the largest gain of one: how much more probable it makes
  // its surface than what was there, in the mean of its pixels.
  double add(const Candidates& found, const RoundOptions& options) {
    std::vector<const Candidate*> probable;
    for (const Candidate& candidate : found) {
      if (candidate.probability < std::min(options.min_gain, options.min_certain)) continue;
      if (!candidate.explained.empty()) probable.push_back(&candidate);
    }
    // The right one first: worse poses of its place are no gain.
    std::ranges::stable_sort(probable, std::greater(), &Candidate::probability);
    double most = 0;
    for (const Candidate* candidate : probable) {
      const auto now = static_cast<float>(candidate->probability);
      const bool is_certain = candidate->probability >= options.min_certain;
      double gain = 0;
      for (const std::uint32_t pixel : candidate->explained) {
        gain += double{std::max(0.0f, now - probability[pixel])};
        probability[pixel] = std::max(probability[pixel], now);
        if (is_certain && !std::exchange(certain[pixel], 1)) newly_certain.push_back(pixel);
      }
      most = std::max(most, gain / static_cast<double>(candidate->explained.size()));
    }
    return most;
  }
};

// The share of a whole round that the next one is; 0 where no other fits.
double next_share(const SearchPace& pace, const TimePlan& time, int round,
                  const Deadline& rounds_end) {
  const double part = round == 0 ? time.first_round : time.next_round;
  const double share =
      pace.share_of_round(part * rounds_end.milliseconds_left(), time.smallest_round);
  return round == 0 ? std::max(share, time.smallest_round) : share;
}

}  // namespace

Candidates LibrarySearch::run(ModelSearches& searches, bool& cut, SearchEffort& effort) const {
  const SearchPlan& plan = inputs.plan;
  Explained explained(inputs.scene.image.pixels.size());
  const bool follows = !inputs.request.expected.empty();
  const auto explain = [&] {
    Candidates all = joined(searches.found());
    let_compete(all, find_overlaps(all, plan.detect.limits[Limit::competing]));
    return explained.add(all, plan.rounds);
  };
  const bool limited = plan.limited;
  const Deadline rounds_end = deadline.part(plan.time.rounds);
  if (follows) {
    searches.score_expected(rounds_end);
    explain();
  }
  SearchPace pace(costs, preparation_ms, static_cast<int>(inputs.models.size()));
  double looked_at = 0;                 // of the scene, in whole rounds
  double gained = 0, looked_since = 0;  // probability, and whole rounds, since that was last judged
  double gained_before = 1;             // when it was last judged
  bool ended = false;                   // before time did
  for (int round = 0; !ended && looked_at < plan.rounds.max_rounds; ++round) {
    const double wanted = round == 0 ? plan.end.first_share : 1;
    const double share =
        limited ? std::min(wanted, next_share(pace, plan.time, round, rounds_end)) : wanted;
    if (share == 0) break;
    const Stopwatch watch;
    const bool any_left =
        searches.run_round({.number = round,
                            .share = share,
                            .hurried = share < wanted,
                            .first_sample = round == 0 && share == 1 && !limited && !follows,
                            .newly_certain = std::exchange(explained.newly_certain, {}),
                            .deadline = rounds_end});
    if (!any_left) {
      ended = true;
      break;
    }
    ++effort.rounds;
    pace.took(share, watch.milliseconds());
    looked_at += share;
    looked_since += share;
    gained = std::max(gained, explain());
    if (on_round) on_round(joined(without_duplicates(inputs, searches.found())));
    const bool may_end = plan.end.may_end_at_first;
    if (looked_since < 1 && !(may_end && round == 0)) continue;
    ended =
        (may_end || looked_at >= 2) &&
        (gained < plan.end.min_gain || std::max(gained, gained_before) < plan.end.min_gain_of_two);
    gained_before = gained;
    gained = looked_since = 0;
  }
  const double final_share = limited ? pace.share_of_final(deadline.milliseconds_left()) : 1;
  searches.finish({.share = final_share,
                   .newly_certain = std::exchange(explained.newly_certain, {}),
                   .deadline = deadline});
  effort += searches.effort();
  const bool whole = ended || looked_at >= plan.rounds.max_rounds;
  cut = searches.late() || !whole || final_share < 1;
  return joined(searches.found());
}

}  // namespace bpa
