// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/library_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/pipeline/search_plan.hpp"
#include "core/scene/interpretations.hpp"

namespace bpa {
namespace {

// Chosen by hand: of the search, for the rounds, so that the final stages have time too; and of
// what the rounds have left, for one of them, which is guessed.
constexpr double kTimeOfRounds = 0.7, kTimeOfFirstRound = 0.5, kTimeOfNextRound = 0.8;

Candidates joined(const std::vector<Candidates>& found) {
  Candidates all;
  for (const Candidates& of_model : found) all.insert(all.end(), of_model.begin(), of_model.end());
  return all;
}

// What the placements found so far explain.
struct Explained {
  std::vector<std::uint8_t> certain, likely;  // flags of pixels; the certain are searched no more
  std::vector<std::uint32_t> newly_certain;   // pixels, since they were last taken

  explicit Explained(std::size_t pixels) : certain(pixels, 0), likely(pixels, 0) {}

  // Returns the number of pixels that have become likely; with `new_places`, only those of
  // placements where nothing was likely. `found` are placements that compete.
  int add(const Candidates& found, const RoundOptions& options, bool new_places) {
    constexpr double kNewPlace = 0.5;  // of its pixels: not likely before. Chosen by hand.
    int gained = 0;
    for (const Candidate& candidate : found) {
      if (candidate.probability < std::min(options.min_likely, options.min_certain)) continue;
      const bool is_certain = candidate.probability >= options.min_certain;
      int fresh = 0;
      for (const std::uint32_t pixel : candidate.explained) {
        fresh += std::exchange(likely[pixel], 1) == 0;
        if (is_certain && !std::exchange(certain[pixel], 1)) newly_certain.push_back(pixel);
      }
      const auto size = static_cast<double>(candidate.explained.size());
      if (!new_places || fresh > kNewPlace * size) gained += fresh;
    }
    return gained;
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
  // Then poses were aligned well before: another round is worth its time for new places alone.
  const bool follows = !inputs.request.expected.empty();
  const auto explain = [&] {
    Candidates all = joined(searches.found());
    let_compete(all, find_overlaps(all, options.scene.max_shared));
    return explained.add(all, options.rounds, follows);
  };
  const bool limited = !deadline.never();
  const Deadline rounds_end = deadline.part(kTimeOfRounds);
  if (follows) {
    searches.score_expected(rounds_end);
    explain();
  }
  SearchPace pace(preparation_ms, static_cast<int>(inputs.models.size()));
  double looked_at = 0;                 // of the scene, in whole rounds
  double gained = 0, looked_since = 0;  // pixels, and whole rounds, since the gain was last judged
  // The gain judged before. The first round never ends the search, unless it follows another.
  double gained_before = follows ? 0 : std::numeric_limits<double>::infinity();
  bool ended = false;  // before time did
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
    gained += explain();
    if (on_round) on_round(joined(without_duplicates(inputs, searches.found())));
    if (looked_since < 1 && !first_after_another) continue;
    ended = gained + gained_before < options.rounds.min_gain_px;
    gained_before = std::exchange(gained, 0);
    looked_since = 0;
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
