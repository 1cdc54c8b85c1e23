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

// Of the search, for the rounds, so that the final stages have time too; and of what the rounds
// have left, for one of them, which is guessed. Chosen by hand. With 0.7 and with 0.82 for the
// rounds, two seeds find 320/758 and 341/758 objects of YCB-Video and of seeds 100 and 777 in
// 0.1 s, and 540/758 and 541/758 in 0.5 s.
constexpr double kTimeOfRounds = 0.82, kTimeOfFirstRound = 0.5, kTimeOfNextRound = 0.8;

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
double next_share(const SearchPace& pace, int round, const Deadline& rounds_end) {
  const double part = round == 0 ? kTimeOfFirstRound : kTimeOfNextRound;
  const double share = pace.share_of_round(part * rounds_end.milliseconds_left());
  return round == 0 ? std::max(share, kSmallestRound) : share;
}

}  // namespace

Candidates LibrarySearch::run(ModelSearches& searches, bool& cut, SearchEffort& effort) const {
  const DetectorOptions& options = inputs.options;
  Explained explained(inputs.scene.image.pixels.size());
  const bool follows = !inputs.request.expected.empty();
  const auto explain = [&] {
    Candidates all = joined(searches.found());
    let_compete(all, find_overlaps(all, options.scene.max_shared));
    return explained.add(all, options.rounds);
  };
  const bool limited = !deadline.never();
  const Deadline rounds_end = deadline.part(kTimeOfRounds);
  if (follows) {
    searches.score_expected(rounds_end);
    explain();
  }
  SearchPace pace(preparation_ms, static_cast<int>(inputs.models.size()));
  double looked_at = 0;                 // of the scene, in whole rounds
  double gained = 0, looked_since = 0;  // probability, and whole rounds, since that was last judged
  double gained_before = 1;             // when it was last judged
  bool ended = false;                   // before time did
  for (int round = 0; !ended && looked_at < options.rounds.max_rounds; ++round) {
    const bool first_after_another = follows && round == 0;
    const double wanted = first_after_another ? options.rounds.expected_share : 1;
    const double share = limited ? std::min(wanted, next_share(pace, round, rounds_end)) : wanted;
    if (share == 0) break;
    const Stopwatch watch;
    const bool any_left =
        searches.run_round({.number = round,
                            .share = share,
                            .raised = share < wanted,
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
    if (looked_since < 1 && !first_after_another) continue;
    // The first round never ends the search, unless it follows another.
    ended = follows ? gained < options.rounds.min_gain_expected
                    : looked_at >= 2 &&
                          (gained < options.rounds.min_gain ||
                           std::max(gained, gained_before) < options.rounds.min_gain_of_two);
    gained_before = gained;
    gained = looked_since = 0;
  }
  const double final_share = limited ? pace.share_of_final(deadline.milliseconds_left()) : 1;
  searches.finish({.share = final_share,
                   .newly_certain = std::exchange(explained.newly_certain, {}),
                   .deadline = deadline});
  effort += searches.effort();
  const bool whole = ended || looked_at >= options.rounds.max_rounds;
  cut = searches.late() || !whole || final_share < 1;
  return joined(searches.found());
}

}  // namespace bpa
